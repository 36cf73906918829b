"""The true world in one physics client: floor, robot, tables and other objects, grasps, and the clock.

Time passes in ticks of 1/240 s. Either the physics is stepped, or joints are set along a motion and the clock is
advanced; held objects move with the hand in both cases.
"""

import colorsys
import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skolem.sim.physics import recording
from skolem.sim.physics.recording import NamedPose
from skolem.sim.robot import bodies
from skolem.sim.robot.bullet import p
from skolem.sim.robot.pr2 import CAMERA_FRAME, PR2, TORSO
from skolem.sim.robot.rotations import rotation
from skolem.sim.space.pinhole import Frame
from skolem.sim.truth.bodies import TrueBody
from skolem.traces.messages import Hand, ObjectType, Pose2, Pose4, TrueObject
from skolem.traces.messages.poses import Quaternion, Vector3, compose4, inverse4, quaternion_xyzw, raised

Recorder = Callable[[str, Any], None]  # topic, protobuf message

RECORD_TICKS = 24  # 10 Hz
SUPPORT_GAP_M = 0.01  # an object whose base is this near the top of a table rests on it
TOUCH_M = 0.002  # bodies this deep in each other collide; resting contacts of the solver are shallower


@dataclass(frozen=True, slots=True)
class Placed:
    """A body in the physics client, with its true body and type."""

    body: int
    kind: ObjectType
    true_body: TrueBody


@dataclass(frozen=True, slots=True)
class Grasp:
    """A grasp: the object's id, the constraint, and the pose of the object's centre in the tool frame."""

    id: str
    constraint: int
    position: Vector3
    quaternion: Quaternion


class World:
    """The robot and the true bodies around it; it alone holds the truth.

    Attributes:
        client: Physics client of its own.
        robot: The PR2 in it.
        placed: All bodies by id, sorted, tables first.
        grasps: The grasps by hand.
        tick: Simulated time in ticks.
    """

    def __init__(
        self,
        types: dict[str, ObjectType],
        true_bodies: Sequence[TrueBody],
        world_T_base: Pose2,
        torso: float,
        recorder: Recorder | None,
    ) -> None:
        """Load floor, robot, tables and other objects; this order is fixed, so that runs repeat."""
        self.client = bodies.connect()
        self._floor = bodies.floor(self.client)
        self.robot = PR2(self.client)
        self.robot.set_base(world_T_base)
        self.robot.set_joints({TORSO: torso})
        ordered = sorted(true_bodies, key=lambda true_body: (types[true_body.type].shape != "table", true_body.id))
        self.placed = {true_body.id: self._load(types[true_body.type], true_body) for true_body in ordered}
        self.grasps: dict[Hand, Grasp] = {}
        self.tick = 0
        self._recorder = recorder
        self._names = {index: name for name, index in self.robot.joint.items()}

    def _load(self, kind: ObjectType, true_body: TrueBody) -> Placed:
        rgba = (*colorsys.hsv_to_rgb(*true_body.hsv), 1.0)
        return Placed(
            bodies.object_body(self.client, kind, true_body.world_T_object, rgba, true_body.kg), kind, true_body
        )

    def close(self) -> None:
        """Close the physics client."""
        bodies.disconnect(self.client)

    # ------------------------------------------------------------ where objects are

    def pose(self, thing_id: str) -> Pose4:
        """Return world_T_object; for an object on its side, its heading and the z that it would have upright."""
        placed = self.placed[thing_id]
        return bodies.pose(self.client, placed.body, placed.kind)

    def base_T_tool(self, hand: Hand) -> Pose4:
        """Return the tool frame in the base frame, from the encoders."""
        return compose4(inverse4(raised(self.robot.base())), self.robot.world_T_tool(hand))

    def world_T_camera(self) -> Frame:
        """Return the true frame of the camera."""
        return Frame(*self.robot.camera_pose())

    def base_T_camera(self) -> Frame:
        """Return the camera frame in the base frame, from the encoders."""
        x, y, theta = self.robot.base()
        position, world_R_camera = self.robot.camera_pose()
        base_R_world = rotation(-theta)
        return Frame(base_R_world @ (position - (x, y, 0.0)), base_R_world @ world_R_camera)

    def base_point(self, link: str) -> NDArray[np.float64]:
        """Return the origin of a link's frame from the encoders, shape (3,), metres, base frame."""
        x, y, theta = self.robot.base()
        return np.asarray(rotation(-theta) @ np.subtract(self.robot.link_pose(link)[0], (x, y, 0.0)))

    def true_objects(self) -> tuple[TrueObject, ...]:
        """Return the true state of every object, tables included."""
        holder = {grasp.id: hand for hand, grasp in self.grasps.items()}
        return tuple(
            TrueObject(
                id=name,
                type=placed.true_body.type,
                world_T_object=self.pose(name),
                hsv=placed.true_body.hsv,
                kg=placed.true_body.kg,
                on=None if name in holder else self._support_of(name),
                in_hand=holder.get(name),
            )
            for name, placed in self.placed.items()
        )

    def _support_of(self, name: str) -> str | None:
        """Return the table on whose top the centre of an object's base face rests, or None."""
        pose = self.pose(name)
        for table, placed in self.placed.items():
            depth, width, height = placed.kind.size_m
            if placed.kind.shape == "table" and table != name and abs(pose[2] - height) < SUPPORT_GAP_M:
                x, y, _, _ = compose4(inverse4(self.pose(table)), pose)
                if abs(x) <= depth / 2.0 and abs(y) <= width / 2.0:
                    return table
        return None

    def put(self, thing_id: str, world_T_object: Pose4) -> None:
        """Put an object at a pose, upright and at rest."""
        placed = self.placed[thing_id]
        bodies.set_pose(self.client, placed.body, placed.kind, world_T_object)

    # ------------------------------------------------------------ what touches, what is carried along

    def carry_along(self) -> None:
        """Move held objects to the hands, after joints were set."""
        for hand, grasp in self.grasps.items():
            position, turn = p.multiplyTransforms(*self.robot.tool_pose(hand), grasp.position, grasp.quaternion)
            body = self.placed[grasp.id].body
            p.resetBasePositionAndOrientation(body, position, turn, physicsClientId=self.client)

    def touching(self) -> bool:
        """Return whether the robot or a held object intersects any other body."""
        p.performCollisionDetection(physicsClientId=self.client)
        held = {self.placed[grasp.id].body for grasp in self.grasps.values()}
        own = held | {self.robot.id}
        ignored = own | {self._floor}
        return any(self._touches(body, ignored) for body in sorted(own))

    def _touches(self, body: int, ignored: set[int]) -> bool:
        contacts = p.getContactPoints(bodyA=body, physicsClientId=self.client)
        return any(contact[2] not in ignored and contact[8] < -TOUCH_M for contact in contacts)

    # ------------------------------------------------------------ identity of a state

    def sha256(self) -> str:
        """Return the hash of joint positions and velocities and of body poses and velocities."""
        digest = hashlib.sha256()
        states = p.getJointStates(self.robot.id, self.robot.movable, physicsClientId=self.client)
        digest.update(np.array([state[:2] for state in states], dtype="<f8").tobytes())
        for placed in self.placed.values():
            position, turn = p.getBasePositionAndOrientation(placed.body, physicsClientId=self.client)
            linear, angular = p.getBaseVelocity(placed.body, physicsClientId=self.client)
            digest.update(np.array([*position, *turn, *linear, *angular], dtype="<f8").tobytes())
        return digest.hexdigest()

    # ------------------------------------------------------------ time

    def step(self) -> None:
        """Run the physics for one tick."""
        p.stepSimulation(physicsClientId=self.client)
        self.pass_time(1)

    def pass_time(self, ticks: int) -> None:
        """Advance the clock without any motion, and record at each tenth of a second."""
        before, self.tick = self.tick, self.tick + ticks
        if self.tick // RECORD_TICKS > before // RECORD_TICKS:
            self.record_state()

    def record(self, topic: str, message: Any) -> None:
        """Pass a message to the recorder, if there is one."""
        if self._recorder is not None:
            self._recorder(topic, message)

    def record_state(self) -> None:
        """Record all joints, and the frames of base, camera and objects."""
        if self._recorder is None:
            return
        names = [self._names[index] for index in self.robot.movable]
        self.record("/robot/joint_states", recording.joint_states(self.tick, names, self.robot.joints(names)))
        self.record("/tf", recording.transforms(self.tick, self._frames()))

    def _frames(self) -> list[NamedPose]:
        x, y, theta = self.robot.base()
        camera = self.robot.link_pose(CAMERA_FRAME)
        frames = [
            NamedPose(recording.BASE_FRAME, (x, y, 0.0), quaternion_xyzw(theta)),
            NamedPose(recording.CAMERA_FRAME, *camera),
        ]
        for name, placed in self.placed.items():
            down = 0.0 if placed.kind.shape == "table" else -placed.kind.size_m[2] / 2.0
            foot = ((0.0, 0.0, down), quaternion_xyzw(0.0))
            position, turn = p.multiplyTransforms(*bodies.full_pose(self.client, placed.body), *foot)
            frames.append(NamedPose(recording.TRUTH_PREFIX + name, position, turn))
        return frames
