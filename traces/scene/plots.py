"""Curves over the steps of a run in a rerun recording: P(Den) of each object, and the entropy of the belief."""

import math
from collections.abc import Iterable

import numpy as np
import rerun as rr

from skolem.traces.messages import Belief, Denotation, ObjectBelief
from skolem.traces.scene.rows import Rows, When
from skolem.traces.wording.wording import AS_RECORDED, Wording

_HELD = rr.components.InterpolationMode.StepAfter  # a value holds until the next decision
_SHOWN = 1e-3  # an object gets a curve only if its P(Den) was once above this
_PALETTE = (
    (90, 200, 250),
    (250, 170, 60),
    (120, 220, 110),
    (240, 100, 140),
    (190, 150, 250),
    (240, 230, 110),
    (110, 220, 200),
    (230, 130, 90),
)
_OFF = 0.3  # distance from a printed number of the axis to its end
_MANY = 8.0  # a longer axis prints only multiples of ten
_GAUSSIAN = math.log(2.0 * math.pi * math.e) / 2.0  # entropy of a normal variable with variance 1
_LEAST_VARIANCE = 1e-10


class Plots:
    """Adds a point to each curve at each decision.

    Attributes:
        words: Words for descriptions.
    """

    def __init__(self, rows: Rows) -> None:
        """Start without curves."""
        self._rows = rows
        self.words: Wording = AS_RECORDED
        self._curves: dict[str, int] = {}
        self._start: dict[str, float] = {}
        self._least, self._most = -1.0, 1.0

    @property
    def entropy_axis(self) -> tuple[float, float]:
        """The range of the axis for all entropies so far, with at least two printed numbers, none at the ends."""
        unit = 1.0 if self._most - self._least < _MANY else 10.0
        return (math.floor(self._least / unit) - _OFF) * unit, math.ceil(self._most) + _OFF

    def meant(self, denotation: Denotation, when: When) -> None:
        """Add P(Den) of each object and description; if there are several descriptions, they are numbered."""
        for expression, table in denotation.probability.items():
            for anchor, p in table.items():
                entity = f"plots/den/{expression}/{anchor}"
                if p >= _SHOWN or entity in self._curves:
                    name = (
                        anchor if len(denotation.probability) == 1 else f"{anchor}: {self.words.described(expression)}"
                    )
                    self._point(entity, name, p, when)

    def believed(self, belief: Belief, when: When) -> None:
        """Add the entropies of the belief, relative to those at the start."""
        for quantity, value in entropies(belief).items():
            change = value - self._start.setdefault(quantity, value)
            self._least, self._most = min(self._least, change), max(self._most, change)
            self._point(f"plots/entropy/{quantity}", quantity, change, when)

    def _point(self, entity: str, name: str, value: float, when: When) -> None:
        if entity not in self._curves:
            number = sum(other.rpartition("/")[0] == entity.rpartition("/")[0] for other in self._curves)
            self._curves[entity] = number
            colour = _PALETTE[number % len(_PALETTE)]
            self._rows.static(entity, rr.SeriesLines(names=name, widths=2.5, colors=colour, interpolation_mode=_HELD))
        self._rows.add(entity, when, rr.Scalars(value))


def entropies(belief: Belief) -> dict[str, float]:
    """Return the mean entropy per object [nats] of poses (joint), types, colours and weights."""
    objects = [belief.objects[anchor] for anchor in belief.anchors]
    return {
        "place": _joint_entropy(belief),
        "type": _mean(_surprise(known.type.values()) for known in objects),
        "colour": _mean(sum(map(_spread, known.colour.variance)) for known in objects),
        "weight": _mean(_weight(known) for known in objects),
    }


def _joint_entropy(belief: Belief) -> float:
    """Return the entropy of base and objects together, per key."""
    size = 3 * len(belief.keys)
    upper = np.zeros((size, size))
    upper[np.triu_indices(size)] = belief.joint_covariance
    covariance = upper + np.triu(upper, 1).T + _LEAST_VARIANCE * np.eye(size)
    _, log_determinant = np.linalg.slogdet(covariance)
    return (size * _GAUSSIAN + float(log_determinant) / 2.0) / max(1, len(belief.keys))


def _weight(known: ObjectBelief) -> float:
    return _spread(known.log_weight[1])


def _spread(variance: float) -> float:
    return _GAUSSIAN + math.log(max(_LEAST_VARIANCE, variance)) / 2.0


def _surprise(probabilities: Iterable[float]) -> float:
    return -sum(p * math.log(p) for p in probabilities if p > 0.0)


def _mean(values: Iterable[float]) -> float:
    found = list(values)
    return sum(found) / max(1, len(found))
