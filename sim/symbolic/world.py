"""A world without physics: the same actions, observations and noise as the PyBullet one, in microseconds.

It leaves out contact, collisions of the base, the arm in the picture, and pixels. It keeps true poses that nobody else
reads, and the errors of wheels, camera, detector and wrist. A hand that closes at the wrong place holds nothing, and a
hand whose corridor is blocked does not reach its target.

May import: detector, truth, symbolic.
"""

import colorsys
import hashlib
import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from skolem.sim.detector.cloud import misplaced
from skolem.sim.detector.detect import Seen, canonical_order, pose_covariance
from skolem.sim.detector.fitting import MODEL_SD_M, UNKNOWN_YAW_SD_RAD
from skolem.sim.detector.likelihood import likeness
from skolem.sim.detector.supports import Support
from skolem.sim.detector.worsen import worsen
from skolem.sim.robot.rotations import rotation
from skolem.sim.space.footprints import Footprint, footprint, overhang
from skolem.sim.space.pinhole import Frame
from skolem.sim.space.surveys import AHEAD
from skolem.sim.symbolic.arm import base_T_tool
from skolem.sim.symbolic.corridors import HAND_M, pillar, standing_in
from skolem.sim.symbolic.view import Solid, camera, depth_view, in_sight, points_in_sight, table_in_sight
from skolem.sim.truth.bodies import TrueBody
from skolem.sim.truth.noise import Extrinsics, Purpose, extrinsic_error, odometry_error, stream, wrist_error
from skolem.traces.messages import (
    GRAVITY,
    HANDS,
    SENSING_HAND,
    TICKS_PER_SECOND,
    Action,
    ActionResult,
    Detection,
    Hand,
    Joints7,
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
    TrueObject,
    TrueState,
    Weigh,
    Wrench,
)
from skolem.traces.messages.arm import CARRY
from skolem.traces.messages.poses import compose2, compose4, flat, inverse2, inverse4, raised, wrap_half_open

TABLE_SD_M, TABLE_SD_RAD = 0.005, 0.01  # of a seen table, in addition to the camera's error
CAPTURE_M, CAPTURE_RAD = 0.03, 0.2  # greatest error of an object's pose at which a hand still closes on it
OPEN_GAP_M = 0.086  # between the open fingers
FULL_POINTS = 2000.0  # pixels on a can one metre from a camera of 320 x 240
PLACE_M = 0.02  # between the places on a top where false detections may stand
SPEED_M, SPEED_RAD = 0.5, 0.7  # of the base, per second
LOOK_S, HAND_S, WEIGH_S = 1.0, 6.0, 1.0  # simulated duration of the other actions
WEIGH_SAMPLES = 48
GRASP_STREAM, PLACE_STREAM = (
    101,
    102,
)  # differ from all numbers of skolem.sim.truth.noise.Purpose, whose world has contacts instead


class SymbolicWorld:
    """The true world, changed by actions in closed form."""

    def __init__(
        self,
        types: Mapping[str, ObjectType],
        bodies: Sequence[TrueBody],
        world_T_base: Pose2,
        torso: float,
        noise: NoiseModel,
        seed: int,
        stated: NoiseModel | None = None,
    ) -> None:
        """Build the world.

        Args:
            types: Every type by name.
            bodies: The true bodies.
            world_T_base: True pose of the base; the arms are in their carry poses.
            torso: Torso lift [m].
            noise: True noise of sensors and wheels.
            seed: Seed of the run.
            stated: Stated noise, from which the detector computes covariances; None: the true noise.
        """
        self._bodies = {body.id: body for body in bodies}
        self._types = dict(types)
        self._noise, self._stated = noise, stated or noise
        self._world_T_base = world_T_base
        self._robot = RobotState(torso=torso, right_arm=CARRY["right"], left_arm=CARRY["left"])
        self._seed = seed
        self._held: dict[Hand, tuple[str, Pose4]] = {}  # the object in each hand and tool_T_object
        self._gaps: dict[Hand, float] = dict.fromkeys(HANDS, OPEN_GAP_M)  # between the fingers
        self._ticks = 0

    @property
    def tick(self) -> int:
        """Simulated time so far, in ticks."""
        return self._ticks

    def close(self) -> None:
        """Do nothing: there is no engine to stop."""

    def robot_state(self) -> RobotState:
        """Return the encoder values."""
        return self._robot

    def state(self, step: int) -> TrueState:
        """Return the truth after `step` actions."""
        held = {name: hand for hand, (name, _) in sorted(self._held.items())}
        objects = tuple(
            TrueObject(
                id=body.id,
                type=body.type,
                world_T_object=body.world_T_object,
                hsv=body.hsv,
                kg=body.kg,
                on=None if body.id in held else self._support(body),
                in_hand=held.get(body.id),
            )
            for body in self._bodies.values()
        )
        numbers = [*self._world_T_base, *(v for body in objects for v in body.world_T_object)]
        digest = hashlib.sha256(struct.pack(f"<{len(numbers)}d", *numbers)).hexdigest()
        return TrueState(step=step, world_T_base=self._world_T_base, objects=objects, sha256=digest)

    def disturb(self, object_id: str, world_T_object: Pose4) -> None:
        """Move an object from outside; an object in a hand is taken out and the fingers close."""
        self._gaps |= {hand: 0.0 for hand, held in self._held.items() if held[0] == object_id}
        self._held = {hand: held for hand, held in self._held.items() if held[0] != object_id}
        self._put(object_id, world_T_object)

    def execute(self, action: Action) -> tuple[ActionResult, Observation]:
        """Carry out an action and return its result and the observation."""
        step, command = action.step, action.command
        match command:
            case MoveBase():
                return self._move(step, command), Observation(step=step, kind="none")
            case LookAt():
                self._robot = self._robot.model_copy(update={"head": (command.pan, command.tilt)})
                self._pass(LOOK_S)
                return self._result(step), self._look(step)
            case Pick():
                return self._pick(step, command), Observation(step=step, kind="none")
            case Place():
                return self._place(step, command), Observation(step=step, kind="none")
            case Weigh():
                return self._weigh(step, command.hand)

    def _pass(self, seconds: float) -> None:
        self._ticks += round(seconds * TICKS_PER_SECOND)

    def _result(
        self, step: int, done: bool = True, tool: Pose4 | None = None, gap: float | None = None
    ) -> ActionResult:
        return ActionResult(
            step=step,
            status="done" if done else "failed",
            robot=self._robot,
            base_T_tool=tool,
            gripper_gap_m=gap,
            gaps_m=self._gaps,
        )

    def _move(self, step: int, command: MoveBase) -> ActionResult:
        self._robot = self._robot.model_copy(update={"head": AHEAD})
        start_T_end: Pose2 = (0.0, 0.0, 0.0)
        for start_T_next in command.start_T_waypoint:
            x, y, turn = compose2(inverse2(start_T_end), start_T_next)
            self._pass(math.hypot(x, y) / SPEED_M + abs(turn) / SPEED_RAD)
            start_T_end = start_T_next
        error = odometry_error(self._noise, start_T_end, stream(self._seed, step, Purpose.ODOMETRY))
        self._world_T_base = compose2(compose2(self._world_T_base, start_T_end), error)
        self._carry_along()
        return self._result(step).model_copy(update={"odometry": start_T_end})

    def _carry_along(self) -> None:
        """Move held objects to their hands."""
        for hand, (name, tool_T_object) in self._held.items():
            self._put(name, compose4(self._world_T_tool(hand, self._arm(hand)), tool_T_object))

    def _arm(self, hand: Hand) -> Joints7:
        return self._robot.right_arm if hand == "right" else self._robot.left_arm

    def _with_arm(self, hand: Hand, joints: Joints7) -> None:
        self._robot = self._robot.model_copy(update={f"{hand}_arm": joints})
        self._carry_along()

    def _world_T_tool(self, hand: Hand, joints: Joints7) -> Pose4:
        return compose4(raised(self._world_T_base), base_T_tool(hand, self._robot.torso, joints))

    def _put(self, name: str, world_T_object: Pose4) -> None:
        self._bodies[name] = replace(self._bodies[name], world_T_object=world_T_object)

    def _pick(self, step: int, command: Pick) -> ActionResult:
        """Close the hand at the end of `reach` on whichever object stands at the planned pose, if any."""
        self._pass(HAND_S)
        hand, joints = command.hand, command.reach[-1]
        world_T_tool = self._world_T_tool(hand, joints)
        name = None if hand in self._held else self._captured(compose4(world_T_tool, command.tool_T_object))
        if name is not None and self._is_barred(name):
            name = None
        gap = 0.0
        if name is not None:
            body = self._bodies[name]
            tool_T_object = compose4(inverse4(world_T_tool), body.world_T_object)
            slip = self._slip(step, GRASP_STREAM, self._noise.grasp_sd_m, self._noise.grasp_sd_rad)
            self._held[hand] = (name, compose4(tool_T_object, slip))
            gap = min(self._types[body.type].size_m[:2])
        if hand in self._held:
            self._gaps = self._gaps | {hand: min(self._types[self._bodies[self._held[hand][0]].type].size_m[:2])}
        self._with_arm(hand, command.carry[-1])
        return self._result(step, name is not None, base_T_tool(hand, self._robot.torso, joints), gap)

    def _captured(self, world_T_planned: Pose4) -> str | None:
        """Return the graspable object nearest to a pose, if it is within the hand's capture volume."""
        held = {name for name, _ in self._held.values()}
        best: tuple[float, str] | None = None
        for body in self._bodies.values():
            kind = self._types[body.type]
            x, y, z, theta = compose4(inverse4(world_T_planned), body.world_T_object)
            offset, twist = (
                math.hypot(x, y),
                0.0 if kind.shape == "cylinder" else abs(wrap_half_open(2.0 * theta)) / 2.0,
            )
            within = offset <= CAPTURE_M and abs(z) <= kind.size_m[2] / 2.0 and twist <= CAPTURE_RAD
            if kind.graspable and body.id not in held and within and (best is None or (offset, body.id) < best):
                best = (offset, body.id)
        return None if best is None else best[1]

    def _is_barred(self, name: str) -> bool:
        """Return whether another object stands in the corridor of a hand to an object."""
        held = {held for held, _ in self._held.values()}
        pillars = {
            body.id: pillar(body.id, self._types[body.type], body.world_T_object)
            for body in self._bodies.values()
            if self._types[body.type].shape != "table" and body.id not in held
        }
        return bool(standing_in(self._world_T_base[:2], pillars[name], pillars.values(), HAND_M))

    def _slip(self, step: int, number: int, sd_m: float, sd_rad: float) -> Pose4:
        """Draw the motion of an object in its own frame when fingers close on it or release it."""
        draws = Generator(PCG64(SeedSequence([self._seed, step, number])))
        x, y, theta = (draws.normal(size=3) * (sd_m, sd_m, sd_rad)).tolist()
        return (x, y, 0.0, theta)

    def _place(self, step: int, command: Place) -> ActionResult:
        """Open the hand at the end of `lower`; the object drops to the surface below it."""
        self._pass(HAND_S)
        hand, joints = command.hand, command.lower[-1]
        held = self._held.pop(hand, None)
        if held is not None:
            name, tool_T_object = held
            slip = self._slip(step, PLACE_STREAM, self._noise.place_sd_m, self._noise.place_sd_rad)
            released = compose4(compose4(self._world_T_tool(hand, joints), tool_T_object), slip)
            self._put(name, released)
            self._put(name, (*released[:2], self._height_below(self._bodies[name]), released[3]))
        self._with_arm(hand, command.carry[-1])
        result = self._result(step, held is not None, base_T_tool(hand, self._robot.torso, joints), OPEN_GAP_M)
        self._gaps = self._gaps | {hand: OPEN_GAP_M}
        return result

    def _support(self, body: TrueBody) -> str | None:
        """Return the table whose top is under an object's centre, or None: the floor."""
        centre = Footprint(flat(body.world_T_object), (0.0, 0.0), 0.0)
        for other in self._bodies.values():
            kind = self._types[other.type]
            if kind.shape == "table" and other.id != body.id and body.world_T_object[2] >= kind.size_m[2] / 2.0:
                if overhang(centre, footprint(kind, flat(other.world_T_object))) <= 0.0:
                    return other.id
        return None

    def _height_below(self, body: TrueBody) -> float:
        support = self._support(body)
        return 0.0 if support is None else self._types[self._bodies[support].type].size_m[2]

    def _weigh(self, step: int, hand: Hand) -> tuple[ActionResult, Observation]:
        """Read the force at the wrist; the left one has no sensor."""
        if hand != SENSING_HAND:
            return self._result(step, False), Observation(step=step, kind="none")
        self._pass(WEIGH_S)
        pull = GRAVITY * self._bodies[self._held[hand][0]].kg if hand in self._held else 0.0
        x, y, z = (wrist_error(self._noise, self._seed, step) - (0.0, 0.0, pull)).tolist()
        wrench = Wrench(hand=hand, force_newton=(x, y, z), samples=WEIGH_SAMPLES)
        return self._result(step), Observation(step=step, kind="weigh", wrench=wrench)

    def _look(self, step: int) -> Observation:
        """Return the observation of a look: detections of the objects in sight, and the depth view."""
        held = {name for name, _ in self._held.values()}
        base_T_world = inverse4(raised(self._world_T_base))
        solids = [
            Solid(body.id, self._types[body.type], compose4(base_T_world, body.world_T_object))
            for body in self._bodies.values()
            if body.id not in held
        ]
        frame = camera(self._robot.torso, *self._robot.head)
        error = extrinsic_error(self._noise, stream(self._seed, step, Purpose.EXTRINSICS))
        seen = [
            self._detection(solid, _misplaced(solid.base_T_solid, frame.origin, frame.axes, error), frame.origin)
            for solid in solids
            if solid.type.graspable and in_sight(frame, solid, [other for other in solids if other.id != solid.id])
        ]
        tables = [solid for solid in solids if solid.type.shape == "table"]
        tops = [_top(frame, solid, [other for other in solids if other.id != solid.id]) for solid in tables]
        edges = [
            self._table_detection(solid, _misplaced(_of_top(solid), frame.origin, frame.axes, error), frame.origin)
            for solid in tables
            if table_in_sight(frame, solid, [other for other in solids if other.id != solid.id])
        ]
        supports = tuple(top for top in tops if len(top.points))
        report = Seen(canonical_order(seen), supports, frame.origin, canonical_order(edges))
        detections = worsen(report, self._types, self._noise, self._stated, self._seed, step)
        view = depth_view(frame, solids, misplaced(frame, error))
        return Observation(step=step, kind="look", detections=detections, view=view)

    def _detection(self, solid: Solid, base_T_seen: Pose4, camera_base: NDArray[np.float64]) -> Detection:
        """Return the detection of one solid, with the error of the camera's calibration."""
        body, upright = self._bodies[solid.id], solid.type.shape == "cylinder"
        x, y, z, theta = base_T_seen
        base_T_object = (x, y, z, 0.0 if upright else wrap_half_open(2.0 * theta) / 2.0)
        fit = np.diag([MODEL_SD_M**2, MODEL_SD_M**2, UNKNOWN_YAW_SD_RAD**2 if upright else MODEL_SD_M**2])
        h, s, v = body.hsv
        distance = float(np.linalg.norm(np.array([x, y, z]) - camera_base))
        return Detection(
            base_T_object=base_T_object,
            covariance=pose_covariance(fit, base_T_object, camera_base, self._stated),
            type_log_likelihood={
                name: likeness(solid.type, kind, distance)
                for name, kind in sorted(self._types.items())
                if kind.graspable
            },
            rgb=colorsys.hsv_to_rgb(h, s, min(1.0, v * self._noise.colour_gain)),
            points=max(1, round(FULL_POINTS / distance**2)),
        )

    def _table_detection(self, solid: Solid, base_T_top: Pose4, camera_base: NDArray[np.float64]) -> Detection:
        """Return the detection of a table whose top is seen at a pose."""
        x, y, z, theta = base_T_top
        base_T_table = (x, y, z - solid.type.size_m[2], wrap_half_open(2.0 * theta) / 2.0)
        fit = np.diag([TABLE_SD_M**2, TABLE_SD_M**2, TABLE_SD_RAD**2])
        h, s, v = self._bodies[solid.id].hsv
        distance = float(np.linalg.norm(np.array([x, y, z]) - camera_base))
        return Detection(
            base_T_object=base_T_table,
            covariance=pose_covariance(fit, (x, y, z, base_T_table[3]), camera_base, self._stated),
            type_log_likelihood={
                name: likeness(solid.type, kind, distance)
                for name, kind in sorted(self._types.items())
                if kind.shape == "table"
            },
            rgb=colorsys.hsv_to_rgb(h, s, min(1.0, v * self._noise.colour_gain)),
            points=max(1, round(FULL_POINTS / distance**2)),
        )


def _misplaced(base_T_solid: Pose4, eye: NDArray[np.float64], axes: NDArray[np.float64], error: Extrinsics) -> Pose4:
    """Return the pose at which a camera with that calibration error believes a solid, still upright."""
    x, y, z, theta = base_T_solid
    point_camera = axes.T @ (np.array([x, y, z]) - eye)
    a, b, c = (eye + axes @ (error.turn @ point_camera + error.shift)).tolist()
    turned = axes @ error.turn @ axes.T @ (math.cos(theta), math.sin(theta), 0.0)
    return (a, b, c, math.atan2(turned[1], turned[0]))


def _of_top(table: Solid) -> Pose4:
    """Return the pose of the middle of a table's top."""
    return compose4(table.base_T_solid, (0.0, 0.0, table.type.size_m[2], 0.0))


def _top(frame: Frame, table: Solid, others: Sequence[Solid]) -> Support:
    """Return a table's top with its visible places where a false detection could stand."""
    width, depth, height = table.type.size_m
    u, v = np.meshgrid(*(np.arange(PLACE_M / 2.0, size, PLACE_M) - size / 2.0 for size in (width, depth)))
    x, y, z, theta = table.base_T_solid
    level = np.stack([u.ravel(), v.ravel(), np.full(u.size, height)], axis=1)
    points = level @ rotation(theta).T + (x, y, z)
    up = np.array([0.0, 0.0, 1.0])
    return Support(up, z + height, np.zeros((0, 3)), points[points_in_sight(frame, points, others)])
