"""Stances for looking at a region: here, if a look shows enough of the unseen part, else where it shows most."""

import math

import numpy as np
from numpy.typing import NDArray

from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.candidates import Candidates
from skolem.sim.planner.trials import STANCE_MARGIN_M
from skolem.sim.space import surveys
from skolem.sim.space.surveys import Survey
from skolem.traces.messages import Belief, LookAt, Pose2

ELSEWHERE_M = 0.5  # after a look that showed nothing new, least distance to the next stance
METRE_COST = 0.02  # shown share that a metre of driving costs


class Surveyor:
    """Compares stances around the support of a region; its comparisons are kept until the belief changes."""

    def __init__(self, world: BelievedWorld, candidates: Candidates) -> None:
        """Keep the world and the source of its stances."""
        self._world = world
        self._candidates = candidates
        self._compared: dict[tuple[str, ...], list[tuple[Pose2, Survey]]] = {}

    def update(self, belief: Belief) -> None:
        """Take over a belief, as the world did."""
        self._belief = belief
        self._compared = {}

    def unseen(self, region: str) -> NDArray[np.float64]:
        """Return the unseen points of a region, shape (n, 3), metres, world; empty if there is no such region."""
        believed = self._belief.regions.get(region)
        support = None if believed is None else self._world.standing.get(believed.support)
        if believed is None or support is None:
            return np.empty((0, 3))
        return surveys.unseen_points(believed, support.world_T_object, support.type.size_m[2])

    def look(self, region: str) -> LookAt | None:
        """Return the look at a region from the believed pose of the robot; None if it must go elsewhere."""
        self._world.reset()
        here = self.from_here(region)
        if here is None or surveys.was_taken(here, self._belief.robot.head):
            return None
        if not surveys.is_worth_it(here, lambda: [found for _, found in self.stances(region)]):
            return None
        return LookAt(pan=here.head[0], tilt=here.head[1])

    def from_here(self, region: str) -> Survey | None:
        """Return the best look at a region from the robot's present pose, however little it shows."""
        return surveys.survey(self._world, self.unseen(region))

    def stances(self, region: str) -> list[tuple[Pose2, Survey]]:
        """Return base poses that show a part of a region, each with its survey, best first."""
        key = (region, *self._world.standing)
        if key not in self._compared:
            points, here = self.unseen(region), self._belief.world_T_base
            found = [] if not len(points) else self._surveys(region, points)
            self._world.reset()
            just = self.from_here(region)
            if just is not None and surveys.was_taken(just, self._belief.robot.head):
                found = [(stance, share) for stance, share in found if math.dist(stance[:2], here[:2]) >= ELSEWHERE_M]
            value = [share.share - METRE_COST * math.dist(stance[:2], here[:2]) for stance, share in found]
            order = np.argsort(-np.round(value, 9), kind="stable")
            self._compared[key] = [found[k] for k in order]
        return self._compared[key]

    def _surveys(self, region: str, points: NDArray[np.float64]) -> list[tuple[Pose2, Survey]]:
        support = self._world.standing[self._belief.regions[region].support]
        middle = (float(points[:, 0].mean()), float(points[:, 1].mean()))
        around = self._candidates.around_region(support, middle, self._belief.world_T_base)
        out = []
        for row in around.world_T_base:
            stance = (float(row[0]), float(row[1]), float(row[2]))
            self._world.reset(stance)
            if self._world.free() and self._world.clear(STANCE_MARGIN_M):
                found = surveys.survey(self._world, points)
                if found is not None and found.share >= surveys.LEAST_SHARE:
                    out.append((stance, found))
        return out
