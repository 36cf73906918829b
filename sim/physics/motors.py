"""The robot's motors in the physics: they hold joints, lead an arm along a path, close and open fingers."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from skolem.sim.physics.world import World
from skolem.sim.robot.bullet import p
from skolem.sim.robot.pr2 import ARM, FINGER_OPEN_RAD, FINGERS
from skolem.traces.messages import TICKS_PER_SECOND, Hand

MOTOR_FORCE = 300.0  # N or Nm, at least: the model's limits assume springs that it lacks
FINGER_FORCE, TIP_FORCE = 6.0, 20.0  # Nm; 6 at a finger is about 55 N at its tip
GEAR_FORCE, GEAR_ERP = 100.0, 0.3  # Nm, and the share of a difference between the fingers corrected per tick
POSITION_GAIN, VELOCITY_GAIN = 0.3, 1.0
FINGER_SPEED_RAD = 0.6  # per second
FINGER_LAG_RAD = 0.05  # fingers this far behind their target are in contact
FINGER_SETTLE_TICKS = 24


class Motors:
    """The position controllers of all joints; targets stay until they are changed."""

    def __init__(self, world: World) -> None:
        """Take over the robot of a world."""
        self._world = world
        self._robot = world.robot
        self._forces = [self._force(index) for index in self._robot.movable]

    def hold(self) -> None:
        """Hold every joint at its present value; called whenever the physics takes over from a kinematic motion."""
        states = p.getJointStates(self._robot.id, self._robot.movable, physicsClientId=self._robot.client)
        self._drive(self._robot.movable, [state[0] for state in states], self._forces)

    def lead_arm(self, hand: Hand, joints: NDArray[np.float64]) -> None:
        """Set the targets of an arm, shape (7,) [rad]."""
        indices = [self._robot.joint[name] for name in ARM[hand]]
        self._drive(indices, joints.tolist(), [MOTOR_FORCE] * len(indices))

    def run(self, ticks: int) -> None:
        """Run the physics with the present targets."""
        for _ in range(ticks):
            self._world.step()

    def close_fingers(self, hand: Hand) -> None:
        """Close the fingers until both press on an object or meet, then hold them.

        Both move alike, so an object that only one of them touches is pushed to the middle.
        """
        target = max(self._fingers(hand)[:2])
        with self._linked_fingers(hand):
            while target > 0.0 and min(self._fingers(hand)[:2]) - target < FINGER_LAG_RAD:
                target = max(0.0, target - FINGER_SPEED_RAD / TICKS_PER_SECOND)
                self._lead_fingers(hand, target)
                self._world.step()
            self.run(FINGER_SETTLE_TICKS)

    def open_fingers(self, hand: Hand) -> None:
        """Open the fingers."""
        target = min(self._fingers(hand)[:2])
        with self._linked_fingers(hand):
            while target < FINGER_OPEN_RAD:
                target = min(FINGER_OPEN_RAD, target + FINGER_SPEED_RAD / TICKS_PER_SECOND)
                self._lead_fingers(hand, target)
                self._world.step()
            self.run(FINGER_SETTLE_TICKS)

    @contextmanager
    def _linked_fingers(self, hand: Hand) -> Iterator[None]:
        """Couple both fingers of a hand as their linkage does; PyBullet ignores the model's `<mimic>`.

        The coupling lasts only while they move, since it would falsify the force at the wrist.
        """
        left, right = (self._robot.joint[name] for name in FINGERS[hand][:2])
        gear = p.createConstraint(
            self._robot.id,
            left,
            self._robot.id,
            right,
            p.JOINT_GEAR,
            (1.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
            physicsClientId=self._robot.client,
        )
        p.changeConstraint(gear, gearRatio=-1.0, erp=GEAR_ERP, maxForce=GEAR_FORCE, physicsClientId=self._robot.client)
        try:
            yield
        finally:
            p.removeConstraint(gear, physicsClientId=self._robot.client)

    def _fingers(self, hand: Hand) -> tuple[float, ...]:
        return self._robot.joints(FINGERS[hand])

    def _lead_fingers(self, hand: Hand, target: float) -> None:
        """Set the target of both fingers; the tips follow the fingers, so that their pads stay parallel."""
        indices = [self._robot.joint[name] for name in FINGERS[hand]]
        tips = self._fingers(hand)[:2]
        self._drive(indices, [target, target, *tips], [FINGER_FORCE, FINGER_FORCE, TIP_FORCE, TIP_FORCE])

    def _drive(self, indices: Sequence[int], targets: Sequence[float], forces: Sequence[float]) -> None:
        p.setJointMotorControlArray(
            self._robot.id,
            indices,
            p.POSITION_CONTROL,
            targetPositions=targets,
            forces=forces,
            positionGains=[POSITION_GAIN] * len(indices),
            velocityGains=[VELOCITY_GAIN] * len(indices),
            physicsClientId=self._robot.client,
        )

    def _force(self, index: int) -> float:
        info = p.getJointInfo(self._robot.id, index, physicsClientId=self._robot.client)
        fingers = {name for names in FINGERS.values() for name in names}
        return FINGER_FORCE if info[1].decode() in fingers else max(MOTOR_FORCE, float(info[10]))
