"""Drawn scenarios, judged again from their text alone by a geometry of their own."""

import math
from dataclasses import dataclass
from functools import cache
from itertools import combinations

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence

from skolem.reasoner.planning.queries import load_rules
from skolem.reasoner.rulebook.book import Rulebook
from skolem.sim.families.words import Words
from skolem.sim.families.writing import scenario_text
from skolem.sim.robot import ik
from skolem.sim.robot.reach import rotations
from skolem.sim.scenario.document import read_document
from skolem.sim.scenario.models import Scenario, WorldObject
from skolem.tools.loop.setup import Setup, compose
from skolem.tools.loop.verdict import verdict
from skolem.traces.messages import Pose2, TrueObject, TrueState
from skolem.traces.messages.poses import compose2, inverse2

Shape = tuple[Pose2, float, float, float]  # world_T_centre, half extents, radius around them
BASE_M = 0.334  # half the side of the base
ARM_M = 1.25
SAMPLES = 400


@cache
def rulebook() -> Rulebook:
    return load_rules()


def words() -> Words:
    return Words(rulebook().vocabulary.types, rulebook().vocabulary.meanings)


@cache
def world_of(family: str, seed: int) -> "DrawnWorld":
    document = read_document(f"{family} {seed}", scenario_text(family, seed, words()))
    return DrawnWorld(compose(document, seed, "symbolic"))


@dataclass(frozen=True)
class DrawnWorld:
    """A drawn scenario, read from its text."""

    setup: Setup

    @property
    def scenario(self) -> Scenario:
        return self.setup.scenario

    def item(self, name: str) -> WorldObject:
        return next(item for item in self.scenario.world if item.id == name)

    def place(self, item: WorldObject) -> Pose2:
        return item.at if item.on is None else compose2(self.item(item.on).at, item.at)

    def shape(self, kind: str, at: Pose2) -> Shape:
        what = self.setup.types[kind]
        if what.shape == "cylinder":
            return at, 0.0, 0.0, what.size_m[0] / 2.0
        return at, what.size_m[0] / 2.0, what.size_m[1] / 2.0, 0.0

    def overlapping(self) -> list[tuple[str, str]]:
        """Return the pairs of objects that overlap."""
        return [
            (a.id, b.id)
            for a, b in combinations(self.scenario.world, 2)
            if a.on == b.on and meet(self.shape(a.type, self.place(a)), self.shape(b.type, self.place(b)))
        ]

    def overhanging(self) -> list[str]:
        """Return the objects that reach beyond the edge of their table, at the start or after a move."""
        moved = [(self.item(move.id).type, move.id, move.on, move.at) for move in self.scenario.disturbances]
        things = [*((item.type, item.id, item.on, item.at) for item in self.scenario.world), *moved]
        return [name for kind, name, on, at in things if on is not None and self._hangs(kind, on, at)]

    def _hangs(self, kind: str, on: str, at: Pose2) -> bool:
        length, width, _ = self.setup.types[self.item(on).type].size_m
        _, x, y, radius = self.shape(kind, at)
        corners = [compose2(at, (sx * x, sy * y, 0.0)) for sx in (-1, 1) for sy in (-1, 1)]
        return any(abs(u) + radius > length / 2.0 or abs(v) + radius > width / 2.0 for u, v, _ in corners)

    def true_if(self, places: dict[str, tuple[str, Pose2]], gone: frozenset[str] = frozenset()) -> bool:
        """Return whether the goal is true with some objects at other places and the `gone` ones away."""
        objects = []
        for item in self.scenario.world:
            if item.id in gone:
                continue
            on, at = places.get(item.id, (item.on, item.at))
            x, y, theta = at if on is None else compose2(self.item(on).at, at)
            z = 0.0 if on is None else self.setup.types[self.item(on).type].size_m[2]
            hsv, kg = item.hsv or (0.083, 0.46, 0.65), item.kg or 30.0
            objects.append(
                TrueObject(id=item.id, type=item.type, world_T_object=(x, y, z, theta), hsv=hsv, kg=kg, on=on)
            )
        state = TrueState(step=0, world_T_base=(0.0, 0.0, 0.0), objects=tuple(objects), sha256="")
        return verdict(self.setup.goal, self.setup.rulebook, state, self.setup.types).true

    def graspable(self) -> list[WorldObject]:
        return [item for item in self.scenario.world if self.setup.types[item.type].graspable]

    def tables(self) -> list[WorldObject]:
        return [item for item in self.scenario.world if item.on is None]

    def base_fits(self, at: Pose2) -> bool:
        """Return whether the base stands free of all tables."""
        base: Shape = (at, BASE_M, BASE_M, 0.0)
        return not any(meet(base, self.shape(table.type, table.at)) for table in self.tables())

    def arm_reaches(self, item: WorldObject, stand: Pose2) -> bool:
        """Return whether an arm has a joint solution for a level grasp of an object from a base pose."""
        x, y, theta = compose2(inverse2(stand), self.place(item))
        what = self.setup.types[item.type]
        z = self.setup.types["table"].size_m[2] + max(0.045, 0.6 * what.size_m[2])
        if what.shape == "cylinder":
            yaws = list(np.linspace(-0.6, 0.6, 5))
        else:
            yaws = [yaw for k in (1, 3) if abs(yaw := math.remainder(theta + k * math.pi / 2, 2 * math.pi)) < 0.9]
        for hand in ("right", "left"):
            pan = ik.pan_grid(hand, 24)
            for yaw in yaws:
                turn = rotations(np.array([yaw]))[0]
                if len(ik.all_solutions(hand, self.scenario.robot.torso_m, np.array([x, y, z]), turn, pan)):
                    return True
        return False

    def stands_near(self, item: WorldObject) -> list[Pose2]:
        """Return drawn base poses that are free and no farther from the object than an arm is long."""
        draw = Generator(PCG64(SeedSequence([self.setup.seed, 1])))
        x, y, _ = self.place(item)
        found = []
        for _ in range(SAMPLES):
            away, around, theta = ARM_M * math.sqrt(draw.random()), *draw.uniform(-math.pi, math.pi, 2)
            at = (x + away * math.cos(around), y + away * math.sin(around), float(theta))
            found += [at] if self.base_fits(at) else []
        return found

    def room_on(self, table: str, kind: str) -> list[Pose2]:
        """Return drawn places on a table at which an object overlaps no object that cannot be lifted."""
        draw = Generator(PCG64(SeedSequence([self.setup.seed, 2])))
        length, width, _ = self.setup.types[self.item(table).type].size_m
        fixed = [item for item in self.scenario.world if item.on == table and item not in self.graspable()]
        found = []
        for _ in range(SAMPLES):
            u, v, theta = draw.uniform((-length / 2, -width / 2, -3.0), (length / 2, width / 2, 3.0))
            at = (float(u), float(v), float(theta))
            shape = self.shape(kind, at)
            if not self._hangs(kind, table, at) and not any(meet(shape, self.shape(f.type, f.at)) for f in fixed):
                found.append(at)
        return found


def meet(a: Shape, b: Shape) -> bool:
    """Return whether two shapes overlap: no axis of either and no axis between two corners separates them."""
    axes = [turn + k * math.pi / 2 for (_, _, turn), *_ in (a, b) for k in (0, 1)]
    axes += [math.atan2(q[1] - p[1], q[0] - p[0]) for p in _corners(a) for q in _corners(b)]
    for angle in axes:
        (low_a, high_a), (low_b, high_b) = _shadow(a, angle), _shadow(b, angle)
        if high_a <= low_b + 1e-4 or high_b <= low_a + 1e-4:
            return False
    return True


def _corners(shape: Shape) -> list[tuple[float, float]]:
    at, x, y, _ = shape
    return [compose2(at, (sx * x, sy * y, 0.0))[:2] for sx in (-1, 1) for sy in (-1, 1)]


def _shadow(shape: Shape, angle: float) -> tuple[float, float]:
    along = [x * math.cos(angle) + y * math.sin(angle) for x, y in _corners(shape)]
    return min(along) - shape[3], max(along) + shape[3]
