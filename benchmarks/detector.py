"""Measurements of the detector on rendered tabletops that are hard to see, with the simulator's truth."""

import colorsys
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linear_sum_assignment

from benchmarks.detector_scenes import CLUTTER_M, STOOD_APART_M, Scene, Thing, cloud, hidden, scattered, touching
from benchmarks.headings import least_turn
from benchmarks.tables import Table, Target
from skolem.estimation.se2 import symmetric
from skolem.reasoner.planning.queries import load_rules
from skolem.sim.detector.detect import detect
from skolem.sim.detector.likelihood import HEIGHT_SD_PER_M2, OUTLINE_SD_PER_M2
from skolem.traces.messages import Detection, NoiseModel, ObjectType
from skolem.traces.messages.likeliest import likeliest

SCENES = 10  # number for each condition
NEAR_M = 0.03  # a detection farther from every object is false
NOISE = (
    NoiseModel(  # as in the scenarios, but without drawn misses, confusions and false alarms: the detector has its own
        depth_sd_scale=1.0,
        extrinsics_sd_m=0.003,
        extrinsics_sd_rad=0.004,
        found=0.9,
        false_per_look=0.1,
        type_right=0.95,
        colour_gain=0.83,
        colour_sd_rgb=0.03,
        odometry_sd_m=0.0,
        odometry_sd_per_m=0.0,
        odometry_sd_rad=0.0,
        odometry_sd_per_rad=0.0,
        wrist_sd_newton=0.0,
        wrist_drift_newton=0.0,
        grasp_sd_m=0.0,
        grasp_sd_rad=0.0,
        place_sd_m=0.0,
        place_sd_rad=0.0,
    )
)
LIGHTS = {"front": (-1.0, 0.0, 0.5), "left": (0.0, 1.0, 0.5), "behind": (1.0, 0.0, 0.5)}
TABLES_M = (0.45, 0.68, 0.90)
HIDDEN = (0.3, 0.5, 0.7)
ALIKE, CLUTTER, TOUCHING = "look-alikes", "3 cm apart", "touching"
CAUTIOUS = 0.5  # mean NEES of headings below which their covariances are clearly too large
BINS = (0.5, 0.7, 0.9, 0.99)  # lower edges of the reliability table; the first edge is 0


def look_alikes() -> dict[str, ObjectType]:
    """Return types that differ by less than a centimetre in height or 4 mm in width."""
    return {
        "mug": ObjectType(shape="cylinder", size_m=(0.068, 0.068, 0.100), graspable=True),
        "soda": ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True),
        "tea": ObjectType(shape="cylinder", size_m=(0.070, 0.070, 0.110), graspable=True),
        "tin": ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.107), graspable=True),
    }


@dataclass(slots=True)
class Tally:
    """The results of the scenes of one condition.

    Attributes:
        asked, found, false: Number of objects to find, of objects found, and of false detections.
        right: Number of objects found whose likeliest reported type is the true one.
        errors_mm: Position errors of the objects found.
        squares: Their squared normalised position errors, with mean 2 if the covariances are right.
        heights_mm: Errors of the height at which they stand.
        headings: Heading error in degrees and squared normalised error of each box found with its true type, against
            the nearest heading at which the box looks alike. Other objects show no heading.
        hue_errors: Hue errors of the objects found.
        seconds: CPU time of each frame.
        claims: Probability of each reported type, and whether it was the true one.
    """

    asked: int = 0
    found: int = 0
    false: int = 0
    right: int = 0
    errors_mm: list[float] = field(default_factory=list)
    squares: list[float] = field(default_factory=list)
    heights_mm: list[float] = field(default_factory=list)
    headings: list[tuple[float, float]] = field(default_factory=list)
    hue_errors: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    claims: list[tuple[float, bool]] = field(default_factory=list)


def scenes(types: dict[str, ObjectType], alike: dict[str, ObjectType]) -> Iterator[tuple[Scene, dict[str, ObjectType]]]:
    """Return every scene, with the types of its objects."""
    for number in range(SCENES):
        yield scattered("apart", number, types, 3, STOOD_APART_M), types
        yield scattered(CLUTTER, number, types, 6, CLUTTER_M), types
        yield touching(number, types), types
        for share in HIDDEN:
            yield hidden(number, share, types), types
        yield scattered(ALIKE, number, alike, 4, STOOD_APART_M), alike
        for name, direction in LIGHTS.items():
            yield scattered(f"light from {name}", number, types, 3, STOOD_APART_M, light=direction), types
        for table_m in TABLES_M:
            yield scattered(f"table at {table_m:.2f} m", number, types, 3, STOOD_APART_M, table_m), types


def measured() -> dict[str, Tally]:
    """Return the results of each condition, in order."""
    types = load_rules().vocabulary.types
    graspable = {name: kind for name, kind in sorted(types.items()) if kind.graspable}
    tallies: dict[str, Tally] = {}
    for scene, known in scenes(graspable, look_alikes()):
        judge(scene, known, tallies.setdefault(scene.condition, Tally()))
    return tallies


def judge(
    scene: Scene, types: dict[str, ObjectType], tally: Tally, noise: NoiseModel = NOISE, near_m: float = NEAR_M
) -> None:
    """Run the detector on a scene, and count the results."""
    seen = cloud(scene, types, noise)
    start = time.process_time()
    detections = detect(seen, types, noise).detections
    tally.seconds.append(time.process_time() - start)
    pairs = matched(scene, detections, near_m)
    tally.asked += len(scene.asked)
    tally.false += len(detections) - len(pairs)
    for i in scene.asked:
        if i in pairs:
            tally.found += 1
            _compare(scene.things[i], detections[pairs[i]], types, tally)


def matched(scene: Scene, detections: tuple[Detection, ...], near_m: float = NEAR_M) -> dict[int, int]:
    """Return the detection of each detected object: nearest pairs first, and none farther apart than `near_m`."""
    if not detections:
        return {}
    apart = np.array([[math.dist(t.world_T_object[:2], d.base_T_object[:2]) for d in detections] for t in scene.things])
    rows, columns = linear_sum_assignment(np.minimum(apart, near_m))
    return {int(i): int(j) for i, j in zip(rows, columns, strict=True) if apart[i, j] < near_m}


def _compare(thing: Thing, detection: Detection, types: dict[str, ObjectType], tally: Tally) -> None:
    best, probability = claim(detection)
    tally.right += best == thing.type
    tally.claims.append((probability, best == thing.type))
    off, covariance = np.subtract(thing.world_T_object, detection.base_T_object), symmetric(detection.covariance)
    tally.errors_mm.append(1e3 * float(np.hypot(*off[:2])))
    tally.heights_mm.append(1e3 * abs(float(off[2])))
    c, s = math.cos(detection.base_T_object[3]), math.sin(detection.base_T_object[3])
    own = np.array([[c, s], [-s, c]]) @ off[:2]
    tally.squares.append(float(own @ np.linalg.solve(covariance[:2, :2], own)))
    if types[best].shape == "box" and best == thing.type:
        turn = least_turn(float(off[3]), types[best])
        tally.headings.append((math.degrees(abs(turn)), turn**2 / float(covariance[2, 2])))
    tally.hue_errors.append(abs(math.remainder(_hue(detection.rgb) - thing.hsv[0], 1.0)))


def _hue(rgb: tuple[float, float, float]) -> float:
    return colorsys.rgb_to_hsv(*rgb)[0]


def claim(detection: Detection) -> tuple[str, float]:
    """Return the likeliest type and its probability under a uniform prior."""
    likelihood = detection.type_log_likelihood
    best = likeliest(likelihood)
    return best, 1.0 / sum(math.exp(value - likelihood[best]) for value in likelihood.values())


def reliability(claims: list[tuple[float, bool]]) -> list[tuple[float, float, int]]:
    """Return (mean claimed probability, share of right claims, count) for each bin of the claimed probability."""
    table = []
    for low, high in zip((0.0, *BINS), (*BINS, math.inf), strict=True):
        inside = [(p, right) for p, right in claims if low <= p < high]
        if inside:
            table.append((float(np.mean([p for p, _ in inside])), float(np.mean([r for _, r in inside])), len(inside)))
    return table


def tables() -> Iterator[Table]:
    """Measure everything and yield one table after another."""
    tallies = measured()
    yield _by_condition(tallies)
    yield _claims(tallies)


def _by_condition(tallies: dict[str, Tally]) -> Table:
    return Table(
        "Detector: difficulty",
        f"{SCENES} rendered tabletops of each kind, 320 x 240, depth and calibration noise of the scenarios. Of the "
        "hidden ones only the hidden thing counts; the share is of its pixels. Look-alikes are four cylinders that "
        "differ by 3 to 15 mm in height and up to 4 mm in width. Place: error of the centre, which the calibration "
        "error of each look (3 mm, 4 mrad) dominates; NEES of the place is 2 if errors are as large as the covariance "
        "says. Height: error of where the thing stands. Heading: of boxes taken for what they are, up to the turns "
        "after which a box looks alike; its NEES is ideally 1. Hue: error of the mean colour, of 1. Time: CPU time of "
        "a frame.",
        (
            *("scene", "things", "recall", "precision", "type right"),
            *("place mm: median", "95 %", "NEES", "height mm: median", "95 %"),
            *("boxes", "heading deg: median", "95 %", "NEES", "hue", "ms"),
        ),
        [(name, *_figures(tally)) for name, tally in tallies.items()],
        notes=tuple(_why_not_all(tallies)),
    )


def _why_not_all(tallies: dict[str, Tally]) -> Iterator[str]:
    """Yield the causes of missed objects and wrong types, if there are any."""
    missed = {name for name, tally in tallies.items() if tally.found < tally.asked}
    mistaken = {name for name, tally in tallies.items() if tally.right < tally.found}
    if TOUCHING in missed | mistaken:
        yield (
            "Things that touch are told apart where outlines of types make up their tops, or where their cluster has a "
            "waist; else they are taken for one thing, or cut in the wrong place. Where things of unlike height touch, "
            "the cut leaves points of the higher one with the lower, which is then taken for the higher type."
        )
    if CLUTTER in missed:
        yield "In clutter a thing is missed that stands right behind a higher one."
    shown = [square for name, tally in tallies.items() if name != TOUCHING for _, square in tally.headings]
    if shown and np.mean(shown) < CAUTIOUS:
        yield (
            f"Headings of boxes that stand apart err less than their covariances say (NEES {np.mean(shown):.2f}): the "
            "points of a fit share the errors of depth steps and of the outline, so they count as one measurement in "
            "each direction, while along the faces of a box much of their error averages out."
        )
    if ALIKE in mistaken:
        yield (
            f"Types that differ by no more than the error of a cluster's height, {1e3 * HEIGHT_SD_PER_M2:.2f} mm times "
            "the squared distance in metres, are not surely told apart by one frame; the likelihoods say so."
        )


def _figures(tally: Tally) -> list[str]:
    found = max(tally.found, 1)
    return [
        str(tally.asked),
        f"{tally.found / tally.asked:.2f}",
        f"{tally.found / max(tally.found + tally.false, 1):.2f}",
        f"{tally.right / found:.2f}",
        f"{np.median(tally.errors_mm):.1f}",
        f"{np.percentile(tally.errors_mm, 95):.1f}",
        f"{np.mean(tally.squares):.2f}",
        f"{np.median(tally.heights_mm):.1f}",
        f"{np.percentile(tally.heights_mm, 95):.1f}",
        *_headings(tally.headings),
        f"{np.median(tally.hue_errors):.3f}",
        f"{1e3 * np.median(tally.seconds):.0f}",
    ]


def _headings(found: list[tuple[float, float]]) -> list[str]:
    if not found:
        return ["0", "-", "-", "-"]
    degrees, squares = np.array(found).T
    return [
        str(len(found)),
        f"{np.median(degrees):.1f}",
        f"{np.percentile(degrees, 95):.1f}",
        f"{np.mean(squares):.2f}",
    ]


def _claims(tallies: dict[str, Tally]) -> Table:
    """Return how often the reported type was right, by its claimed probability."""
    groups = {
        "types of the rules": [claim for name, tally in tallies.items() if name != ALIKE for claim in tally.claims],
        "look-alikes": tallies[ALIKE].claims,
    }
    rows = [
        (name, f"{said:.3f}", f"{right:.3f}", n)
        for name, claims in groups.items()
        for said, right, n in reliability(claims)
    ]
    every = [row for claims in groups.values() for row in reliability(claims)]
    over = max(said - right - _margin(said, n) for said, right, n in every)
    under = max(right - said - _margin(said, n) for said, right, n in every)
    return Table(
        "Detector: reliability",
        "How often the likeliest type was the true one, by the probability that its likelihoods give it (all types "
        "alike before).",
        ("types", "claimed", "right", "number"),
        rows,
        (
            Target(
                "claims no more than it keeps, within two standard errors", over <= 0.0, f"{max(over, 0.0):.3f} above"
            ),
            Target(
                "claims no less than it keeps, within two standard errors", under <= 0.0, f"{max(under, 0.0):.3f} below"
            ),
        ),
        (
            "The belief mixes in the type errors it is told to expect (`type_right`), and never leans wholly on one.",
            *_why_unreliable(groups),
        ),
    )


def _margin(said: float, number: int) -> float:
    """Return two standard errors of the share of right claims, if the claimed probabilities are true."""
    return 2.0 * math.sqrt(max(said * (1.0 - said), 1e-4) / number)


def _why_unreliable(groups: dict[str, list[tuple[float, bool]]]) -> Iterator[str]:
    """Yield the claims that are clearly too high or too low, if there are any."""
    for name, claims in groups.items():
        for said, right, n in reliability(claims):
            if abs(right - said) > _margin(said, n):
                low = (
                    f"less sure than it could be. The likelihoods allow {1e3 * HEIGHT_SD_PER_M2:.2f} mm of error in a "
                    f"cluster's height and {1e3 * OUTLINE_SD_PER_M2:.2f} mm along its outline, times the squared "
                    "distance in metres; here it is less, or it could not be right as often"
                )
                side = low if right > said else "surer than it should be"
                yield f"Of {name}, those called {said:.3f} likely are right {right:.3f} of {n} times: {side}."
