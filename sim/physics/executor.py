"""Motions of the robot in the true world: driving, turning the head, leading an arm along a path.

A motion through free space is kinematic: joints are set along the path, held objects move with the hand, and contacts
are checked after each sample. Motions with contacts run in the physics.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from skolem.sim.physics.motors import Motors
from skolem.sim.physics.world import World
from skolem.sim.robot.pr2 import HEAD
from skolem.traces.messages import TICKS_PER_SECOND, Hand, Joints7, Pose2
from skolem.traces.messages.poses import compose2, wrap_half_open

SAMPLE_TICKS = 12  # of kinematic motions: 2 cm of driving, 0.05 rad of turning
BASE_SPEED_M, BASE_SPEED_RAD = 0.4, 0.8  # per second
ARM_SPEED_RAD, CAREFUL_SPEED_RAD, HEAD_SPEED_RAD = 1.0, 0.5, 1.0  # per second, of the fastest joint
REST_TICKS = 24  # after a motion in the physics

START: Pose2 = (0.0, 0.0, 0.0)
Path = Sequence[Joints7]


@dataclass(frozen=True, slots=True)
class Driven:
    """The outcome of a drive: start_T_end from the wheels, and whether it reached its end."""

    odometry: Pose2
    arrived: bool


class Executor:
    """Moves the robot of a world.

    Attributes:
        motors: The position controllers, for motions in the physics.
    """

    def __init__(self, world: World) -> None:
        """Take over the robot of a world."""
        self._world = world
        self._robot = world.robot
        self.motors = Motors(world)

    def drive(self, start_T_waypoint: Sequence[Pose2], end_error: Pose2) -> Driven:
        """Drive along waypoints from the true pose of the base, with drift; stop before an obstacle.

        Args:
            start_T_waypoint: Waypoints in the frame of the drive's start.
            end_error: end_T_true: the error of the true motion at the last waypoint; on the way it grows with time.
        """
        world_T_start, reached = self._robot.base(), START
        samples = list(_drive_samples((START, *start_T_waypoint)))
        for count, start_T_wheels in enumerate(samples, start=1):
            share = count / len(samples)
            drift = (share * end_error[0], share * end_error[1], share * end_error[2])
            before = self._robot.base()
            self._robot.set_base(compose2(world_T_start, compose2(start_T_wheels, drift)))
            self._world.carry_along()
            if self._world.touching():
                self._robot.set_base(before)
                self._world.carry_along()
                return Driven(reached, False)
            self._world.pass_time(SAMPLE_TICKS)
            reached = start_T_wheels
        return Driven(reached, True)

    def turn_head(self, pan: float, tilt: float) -> None:
        """Turn the head, within its limits; contacts are not checked."""
        goal = [
            min(max(value, self._robot.limits[name][0]), self._robot.limits[name][1])
            for name, value in zip(HEAD, (pan, tilt), strict=True)
        ]
        start = np.array(self._robot.joints(HEAD))
        for values in _samples(start, np.array(goal), HEAD_SPEED_RAD, SAMPLE_TICKS):
            self._robot.set_joints(dict(zip(HEAD, values.tolist(), strict=True)))
            self._world.pass_time(SAMPLE_TICKS)

    def move_freely(self, hand: Hand, path: Path) -> bool:
        """Lead an arm along a path kinematically; return whether it reached the end without touching anything.

        When something is touched, the arm goes back the way it came.
        """
        done = [np.array(self._robot.arm(hand))]
        for values in self._arm_samples(hand, path, ARM_SPEED_RAD, SAMPLE_TICKS):
            self._put_arm(hand, values)
            if self._world.touching():
                for earlier in reversed(done):
                    self._put_arm(hand, earlier)
                    self._world.pass_time(SAMPLE_TICKS)
                return False
            self._world.pass_time(SAMPLE_TICKS)
            done.append(values)
        return True

    def move_in_contact(self, hand: Hand, path: Path, until: Callable[[], bool] = lambda: False) -> None:
        """Lead an arm along a path in the physics, pushing obstacles, until its end or until `until` returns True."""
        self.motors.hold()
        for values in self._arm_samples(hand, path, CAREFUL_SPEED_RAD, 1):
            self.motors.lead_arm(hand, values)
            self._world.step()
            if until():
                break
        self.motors.run(REST_TICKS)

    def move_home(self, hand: Hand, path: Path) -> None:
        """Lead an arm along a path: kinematically up to the first contact, and from there in the physics."""
        samples = self._arm_samples(hand, path, ARM_SPEED_RAD, SAMPLE_TICKS)
        before = np.array(self._robot.arm(hand))
        for values in samples:
            self._put_arm(hand, values)
            if self._world.touching():
                self._put_arm(hand, before)
                self.move_in_contact(hand, [_joints7(values), *(_joints7(rest) for rest in samples)])
                return
            self._world.pass_time(SAMPLE_TICKS)
            before = values

    def _put_arm(self, hand: Hand, values: NDArray[np.float64]) -> None:
        self._robot.set_arm(hand, values.tolist())
        self._world.carry_along()

    def _arm_samples(self, hand: Hand, path: Path, speed: float, ticks: int) -> Iterator[NDArray[np.float64]]:
        """Yield arm configurations along a path, one for each `ticks`.

        Joint values are interpolated directly, since paths have no jumps, even in continuous joints.
        """
        last = np.array(self._robot.arm(hand))
        for waypoint in path:
            goal = np.array(waypoint)
            yield from _samples(last, goal, speed, ticks)
            last = goal


def _samples(
    start: NDArray[np.float64], goal: NDArray[np.float64], speed: float, ticks: int
) -> Iterator[NDArray[np.float64]]:
    """Yield configurations from `start`, exclusive, to `goal`, inclusive, the fastest joint at `speed` [rad/s]."""
    count = math.ceil(float(np.abs(goal - start).max()) / (speed * ticks / TICKS_PER_SECOND))
    for k in range(1, count + 1):
        yield start + (goal - start) * (k / count)


def _drive_samples(start_T_waypoint: Sequence[Pose2]) -> Iterator[Pose2]:
    """Yield base poses along waypoints, straight from each to the next, one for each sample of time."""
    for a, b in pairwise(start_T_waypoint):
        turn = wrap_half_open(b[2] - a[2])
        seconds = max(math.hypot(b[0] - a[0], b[1] - a[1]) / BASE_SPEED_M, abs(turn) / BASE_SPEED_RAD)
        count = math.ceil(seconds * TICKS_PER_SECOND / SAMPLE_TICKS)
        for k in range(1, count + 1):
            share = k / count
            yield (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), wrap_half_open(a[2] + share * turn))


def _joints7(values: NDArray[np.float64]) -> Joints7:
    a, b, c, d, e, f, g = (float(value) for value in values)
    return (a, b, c, d, e, f, g)
