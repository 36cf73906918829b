"""The world with physics: it executes an action and returns a result and an observation.

The results are sensor readings: detections through a noisy camera, odometry of the wheels, exact joint encoders, the
gap between the fingers, the force at the right wrist. `state` is the truth, for verdicts and viewers.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from skolem.sim.detector import cloud
from skolem.sim.detector.detect import detect
from skolem.sim.detector.worsen import worsen
from skolem.sim.physics import camera, recording
from skolem.sim.physics.executor import Executor
from skolem.sim.physics.hand import attach, between_fingers, detach, enable_wrist_sensor, held_touches, wrist_force
from skolem.sim.physics.world import Recorder, World
from skolem.sim.robot.pr2 import FINGER_OPEN_RAD, TOOL_FRAME
from skolem.sim.space.surveys import AHEAD
from skolem.sim.truth.bodies import TrueBody
from skolem.sim.truth.noise import Purpose, extrinsic_error, noisy_depth, odometry_error, stream, wrist_error
from skolem.traces.messages import (
    HANDS,
    SENSING_HAND,
    Action,
    ActionResult,
    Hand,
    LookAt,
    MoveBase,
    NoiseModel,
    ObjectType,
    Observation,
    Pick,
    Place,
    Pose2,
    Pose4,
    RobotState,
    TrueState,
    Weigh,
    Wrench,
)

SETTLE_TICKS, AVERAGE_TICKS = 24, 48  # of a weighing
FALL_TICKS = 90  # in which a released object comes to rest
LIMB_RADIUS_M = 0.10  # points this near an arm's axis belong to the arm
FINGER_REACH_M = 0.06  # the fingers end this far beyond the tool frame
HELD_REACH_M = 0.20  # a held object may reach this far above and below the tool frame
_LIMBS = ("shoulder_pan_link", "elbow_flex_link", "wrist_flex_link")


class PyBulletWorld:
    """A PR2 among tables and other objects, in physics."""

    def __init__(
        self,
        types: dict[str, ObjectType],
        bodies: Sequence[TrueBody],
        world_T_base: Pose2,
        torso: float,
        noise: NoiseModel,
        seed: int,
        recorder: Recorder | None = None,
        images: bool = False,
        stated: NoiseModel | None = None,
    ) -> None:
        """Build the world.

        Args:
            types: Every type by name.
            bodies: The true bodies, in any order.
            world_T_base: True pose of the base.
            torso: Torso lift [m].
            noise: True noise of sensors and wheels.
            seed: Seed of the run.
            recorder: Called with a topic and a protobuf message while the robot moves; `tick` is its time.
            images: Whether pictures are recorded too.
            stated: Stated noise, from which the detector computes covariances; None: the true noise.
        """
        self._types, self._noise, self._seed, self._images = types, noise, seed, images
        self._stated = stated or noise
        self._world = World(types, bodies, world_T_base, torso, recorder)
        self._executor = Executor(self._world)
        enable_wrist_sensor(self._world, SENSING_HAND)
        self._world.record_state()

    @property
    def tick(self) -> int:
        """Simulated time since the start, in 1/240 s."""
        return self._world.tick

    def close(self) -> None:
        """Close the physics client."""
        self._world.close()

    def robot_state(self) -> RobotState:
        """Return the encoder values."""
        return self._world.robot.state()

    def state(self, step: int) -> TrueState:
        """Return the truth."""
        return TrueState(
            step=step,
            world_T_base=self._world.robot.base(),
            objects=self._world.true_objects(),
            sha256=self._world.sha256(),
        )

    def disturb(self, object_id: str, world_T_object: Pose4) -> None:
        """Move an object from outside, unseen by the robot; an object in a hand is taken out and the fingers close."""
        for hand in [hand for hand, grasp in self._world.grasps.items() if grasp.id == object_id]:
            detach(self._world, hand)
            self._world.robot.set_gripper(hand, 0.0)
        self._world.put(object_id, world_T_object)

    def execute(self, action: Action) -> tuple[ActionResult, Observation]:
        """Carry out an action; an impossible one has a failed result."""
        step, command = action.step, action.command
        match command:
            case MoveBase():
                return self._drive(step, command), _nothing(step)
            case LookAt():
                self._executor.turn_head(command.pan, command.tilt)
                return self._result(step, True), self._look(step)
            case Pick():
                return self._pick(step, command), _nothing(step)
            case Place():
                return self._place(step, command), _nothing(step)
            case Weigh():
                return self._weigh(step, command)
            case _:
                assert_never(command)

    def _result(
        self, step: int, done: bool, hand: Hand | None = None, base_T_tool: Pose4 | None = None
    ) -> ActionResult:
        return ActionResult(
            step=step,
            status="done" if done else "failed",
            robot=self.robot_state(),
            base_T_tool=base_T_tool,
            gripper_gap_m=self._world.robot.gripper_gap(hand) if hand else None,
            gaps_m=self._gaps(),
        )

    def _gaps(self) -> dict[Hand, float]:
        """Return how far apart the fingers of each hand are."""
        return {hand: self._world.robot.gripper_gap(hand) for hand in HANDS}

    # ------------------------------------------------------------ driving

    def _drive(self, step: int, command: MoveBase) -> ActionResult:
        path = command.start_T_waypoint
        self._executor.turn_head(*AHEAD)
        draws = stream(self._seed, step, Purpose.ODOMETRY)
        driven = self._executor.drive(path, odometry_error(self._noise, path[-1], draws) if path else (0.0, 0.0, 0.0))
        return ActionResult(
            step=step,
            status="done" if driven.arrived else "stopped_early",
            robot=self.robot_state(),
            odometry=driven.odometry,
            gaps_m=self._gaps(),
        )

    # ------------------------------------------------------------ seeing

    def _look(self, step: int) -> Observation:
        picture, base_T_camera = (
            camera.render(self._world.client, self._world.world_T_camera()),
            self._world.base_T_camera(),
        )
        depth = noisy_depth(picture.depth, self._noise.depth_sd_scale, stream(self._seed, step, Purpose.DEPTH))
        error = extrinsic_error(self._noise, stream(self._seed, step, Purpose.EXTRINSICS))
        rgb = camera.exposed(picture.rgb, self._noise.colour_gain)
        points = cloud.cloud_from_depth(depth, rgb, base_T_camera, error)
        seen = detect(cloud.without_own_body(points, self._limbs(), LIMB_RADIUS_M), self._types, self._stated)
        detections = worsen(seen, self._types, self._noise, self._stated, self._seed, step)
        if self._images:
            self._record_images(rgb, depth)
        view = cloud.depth_view(depth, cloud.misplaced(base_T_camera, error))
        return Observation(step=step, kind="look", detections=detections, view=view)

    def _record_images(self, rgb: NDArray[np.float64], depth: NDArray[np.float64]) -> None:
        rows, columns = depth.shape
        tick, record = self._world.tick, self._world.record
        record("/camera/rgb", recording.colour_image(tick, np.round(255.0 * rgb).astype(np.uint8)))
        record("/camera/depth", recording.depth_image(tick, depth))
        record("/camera/info", recording.calibration(tick, columns, rows))

    def _limbs(self) -> NDArray[np.float64]:
        """Return the axes of the arms and of held objects from the encoders, shape (k, 2, 3), metres, base frame."""
        segments = []
        for hand in HANDS:
            joints = [self._world.base_point(f"{hand[0]}_{name}") for name in _LIMBS]
            wrist, tool = joints[-1], self._world.base_point(TOOL_FRAME[hand])
            joints.append(tool + (tool - wrist) / np.linalg.norm(tool - wrist) * FINGER_REACH_M)
            segments += list(pairwise(joints))
            if hand in self._world.grasps:
                reach = np.array([0.0, 0.0, HELD_REACH_M])
                segments.append((tool - reach, tool + reach))
        return np.array(segments)

    # ------------------------------------------------------------ grasping

    def _pick(self, step: int, command: Pick) -> ActionResult:
        """Close the hand at the end of the path; after a failure it goes back along the path with open fingers."""
        hand, executor = command.hand, self._executor
        if hand in self._world.grasps:
            return self._result(step, False)
        start = self._world.robot.arm(hand)
        self._world.robot.set_gripper(hand, FINGER_OPEN_RAD)
        if not executor.move_freely(hand, command.approach):
            return self._result(step, False)
        executor.move_in_contact(hand, command.reach)
        executor.motors.close_fingers(hand)
        base_T_tool, thing = self._world.base_T_tool(hand), between_fingers(self._world, hand)
        result = self._result(step, thing is not None, hand, base_T_tool)
        if thing is not None:
            attach(self._world, hand, thing)
            executor.move_in_contact(hand, command.lift)
            executor.move_home(hand, command.carry)
        else:
            executor.motors.open_fingers(hand)
            executor.move_in_contact(hand, [*reversed(command.reach), *command.approach[-1:]])
            executor.move_home(hand, [*reversed(command.approach), start])
        return result.model_copy(update={"robot": self.robot_state(), "gaps_m": self._gaps()})

    def _place(self, step: int, command: Place) -> ActionResult:
        """Put down the held object, lowering it to the first contact; an empty hand opens and the action fails."""
        hand, executor = command.hand, self._executor
        if not executor.move_freely(hand, command.approach):
            return self._result(step, False)
        holds = hand in self._world.grasps
        executor.move_in_contact(hand, command.lower, until=lambda: holds and held_touches(self._world, hand))
        base_T_tool = self._world.base_T_tool(hand)
        before = self._gaps()
        if holds:
            detach(self._world, hand)
        executor.motors.open_fingers(hand)
        result = self._result(step, holds, hand, base_T_tool)
        executor.motors.run(FALL_TICKS)
        executor.move_in_contact(hand, command.retreat)
        executor.move_home(hand, command.carry)
        return result.model_copy(update={"robot": self.robot_state(), "gaps_m": before})

    # ------------------------------------------------------------ weighing

    def _weigh(self, step: int, command: Weigh) -> tuple[ActionResult, Observation]:
        """Hold still and average the force at the wrist; the left wrist has no sensor."""
        if command.hand != SENSING_HAND:
            return self._result(step, False), _nothing(step)
        self._executor.motors.hold()
        self._executor.motors.run(SETTLE_TICKS)
        total = np.zeros(3)
        for _ in range(AVERAGE_TICKS):
            self._world.step()
            total += wrist_force(self._world, SENSING_HAND)
        x, y, z = (float(value) for value in total / AVERAGE_TICKS + wrist_error(self._noise, self._seed, step))
        wrench = Wrench(hand=SENSING_HAND, force_newton=(x, y, z), samples=AVERAGE_TICKS)
        return self._result(step, True), Observation(step=step, kind="weigh", wrench=wrench)


def _nothing(step: int) -> Observation:
    return Observation(step=step, kind="none")
