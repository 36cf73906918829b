"""The believed world as bodies in a physics client of its own, in which motions are planned.

Its only source is the belief. Tables and graspable objects stand at their mean poses; graspable objects are wider by
the spread of their pose relative to the robot. For a moving arm, everything is wider still: tables by their spread, all
by a margin. A held object moves with the hand and may touch that hand's gripper only. The physics is never stepped, so
an answer depends on the configuration and on the belief, not on earlier questions.
"""

import contextlib
import dataclasses
import math
from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from skolem.sim.planner.standing import Carried, Standing
from skolem.sim.robot import bodies
from skolem.sim.robot.bullet import p
from skolem.sim.robot.pr2 import ARM, BASE, FINGER_OPEN_RAD, HEAD, PR2
from skolem.sim.space.doubt import Doubts
from skolem.traces.messages import HANDS, Belief, Hand, ObjectType, Pose2, Pose4
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.messages.poses import Vector3, compose2, flat, inverse2, quaternion_xyzw

Floats = NDArray[np.float64]

PENETRATION_M = 1e-4  # shallower contacts are no collisions
EXISTS = 0.5  # objects less likely to exist are no obstacles
SPREAD_LIMIT_M, TABLE_SPREAD_LIMIT_M = 0.05, 0.04
ARM_MARGIN_M = 0.01  # distance of a moving arm to the sides of all objects but its target
RESTING_GAP_M = 0.02  # an object this close above a table stands on it
NEAREST_RAY_M = 0.3  # the camera sees nothing nearer
CENTRED = 1e-3  # tangent of the largest angle between the optical axis and the point looked at
CARRIED_KG = 0.1  # any mass will do: PyBullet reports no contacts between two immovable bodies
_GREY = (0.6, 0.6, 0.6, 1.0)
_AWAY_M, _APART_M = -50.0, 5.0  # height and spacing of parked bodies, which stand for no present belief


class BelievedWorld:
    """The robot and all believed objects at their believed poses; planners try other configurations in it."""

    def __init__(self, types: Mapping[str, ObjectType]) -> None:
        self._types = types
        self.client = bodies.connect(gravity=False)
        self.robot = PR2(self.client, self_collision=True)
        self.standing: dict[str, Standing] = {}
        self._unlikely: dict[str, Standing] = {}
        self.carried: dict[Hand, Carried] = {}
        self._bodies: dict[tuple[str, ObjectType, float, Hand | None, Hand | None], int] = {}
        self._is_narrowed = False
        self._gripper = {
            hand: frozenset(i for name, i in self.robot.link.items() if name.startswith(f"{hand[0]}_gripper"))
            for hand in HANDS
        }
        self._still = {
            hand: tuple(i for name, i in self.robot.collision_links().items() if not name.startswith(f"{hand[0]}_"))
            for hand in HANDS
        }
        self._arm_indices = {hand: [self.robot.joint[name] for name in ARM[hand]] for hand in HANDS}
        self._base_indices = [self.robot.joint[name] for name in BASE]
        self._tool_link = {hand: self.robot.link[f"{hand[0]}_gripper_tool_frame"] for hand in HANDS}

    def close(self) -> None:
        """Close the physics client."""
        bodies.disconnect(self.client)

    def update(self, belief: Belief) -> None:
        """Take over a belief; new objects get bodies, and the bodies of missing ones are parked."""
        self._belief = belief
        self._park_all()
        self.standing, self.carried, self._unlikely = {}, {}, {}
        doubts = Doubts(belief)
        for anchor in belief.anchors:
            believed = belief.objects[anchor]
            object_type = self._types[likeliest(believed.type)]
            if believed.in_hand is not None and believed.tool_T_object is not None:
                body = self._body(anchor, object_type, 0.0, believed.in_hand)
                self.carried[believed.in_hand] = Carried(
                    believed.in_hand, anchor, object_type, believed.tool_T_object, body
                )
                continue
            doubt = doubts.spread(anchor, SPREAD_LIMIT_M if object_type.graspable else TABLE_SPREAD_LIMIT_M)
            wider = doubt if object_type.graspable else 0.0
            own = doubts.own_spread(anchor, SPREAD_LIMIT_M) if object_type.graspable else 0.0
            body = self._body(anchor, object_type, wider, None)
            item = Standing(anchor, object_type, believed.world_T_object, wider, doubt, own, body, believed.support)
            (self.standing if believed.exists >= EXISTS else self._unlikely)[anchor] = item
        self.reset()
        self._narrow_what_touches()

    def _narrow_what_touches(self) -> None:
        """Give objects that the robot would intersect their plain size, since both cannot stand there."""
        for anchor in sorted(self.touched()):
            self.standing[anchor] = self._narrow(self.standing[anchor])

    def _narrow(self, item: Standing) -> Standing:
        """Return an object with a body of its plain size at its mean pose."""
        item = dataclasses.replace(item, own_m=0.0)
        if item.spread_m > 0.0:
            self._park(item.body)
            item = dataclasses.replace(item, spread_m=0.0, body=self._body(item.anchor, item.type, 0.0, None))
            bodies.set_pose(self.client, item.body, item.type, item.world_T_object)
        return item

    @contextlib.contextmanager
    def narrowed(self) -> Iterator[None]:
        """Give all objects their plain size at their mean poses during the context, for moving arms too."""
        wide = self.standing
        self.standing, self._is_narrowed = {anchor: self._narrow(item) for anchor, item in wide.items()}, True
        try:
            yield
        finally:
            for item in self.standing.values():
                self._park(item.body)
            self.standing, self._is_narrowed = wide, False
            self.reset()

    @contextlib.contextmanager
    def wary(self, hand: Hand, target: str | None = None) -> Iterator[None]:
        """Widen objects by their doubt and a margin during the context, for one arm and its carried object alone.

        The target is not widened, nor are objects that the arm would then intersect already.
        """
        if self._is_narrowed:
            yield
            return
        plain = self.standing
        wide = {a: item if a == target else self._widened(item, hand) for a, item in plain.items()}
        self.standing = wide
        met = self.touched()
        self.standing = {a: plain[a] if a in met else item for a, item in wide.items()}
        self._swap(wide, self.standing)
        try:
            yield
        finally:
            self._swap(self.standing, plain)
            self.standing = plain

    def _widened(self, item: Standing, hand: Hand) -> Standing:
        """Return an object with a body that is wider to the sides and collides with an arm alone."""
        body = self._body(item.anchor, item.type, item.doubt_m + ARM_MARGIN_M, None, hand)
        self._park(item.body)
        bodies.set_pose(self.client, body, item.type, item.world_T_object)
        return dataclasses.replace(item, body=body)

    def _swap(self, old: Mapping[str, Standing], new: Mapping[str, Standing]) -> None:
        for anchor, item in new.items():
            if old[anchor].body != item.body:
                self._park(old[anchor].body)
                bodies.set_pose(self.client, item.body, item.type, item.world_T_object)

    @contextlib.contextmanager
    def supposing(self, anchor: str) -> Iterator[None]:
        """Have an object stand where it is believed to meanwhile, however unlikely it exists."""
        item = self._unlikely.get(anchor)
        if item is None or anchor in self.standing:
            yield
            return
        likely = self.standing
        self.standing = likely | {anchor: item}
        bodies.set_pose(self.client, item.body, item.type, item.world_T_object)
        try:
            yield
        finally:
            self.standing = likely
            self._park(item.body)

    @contextlib.contextmanager
    def removed(self, anchors: Collection[str]) -> Iterator[None]:
        """Ignore standing objects during the context."""
        full = self.standing
        self.standing = {anchor: item for anchor, item in full.items() if anchor not in anchors}
        for anchor in anchors:
            self._park(full[anchor].body)
        try:
            yield
        finally:
            self.standing = full
            for anchor in anchors:
                bodies.set_pose(self.client, full[anchor].body, full[anchor].type, full[anchor].world_T_object)

    @contextlib.contextmanager
    def emptied(self, hand: Hand | None) -> Iterator[None]:
        """Ignore the object in a hand during the context."""
        carried = self.carried.pop(hand) if hand in self.carried else None
        if carried is not None:
            self._park(carried.body)
        try:
            yield
        finally:
            if carried is not None:
                self.carried[carried.hand] = carried
                self._move_carried(carried.hand)

    def reset(self, world_T_base: Pose2 | None = None) -> None:
        """Put everything at its believed pose; the robot at `world_T_base`, if given."""
        for item in self.standing.values():
            bodies.set_pose(self.client, item.body, item.type, item.world_T_object)
        for hand in HANDS:
            self.robot.set_gripper(hand, FINGER_OPEN_RAD)
        self.robot.set_state(self._belief.robot)
        self.robot.set_base(self._belief.world_T_base if world_T_base is None else world_T_base)
        for hand in self.carried:
            self._move_carried(hand)

    def _body(
        self, anchor: str, object_type: ObjectType, wider: float, hand: Hand | None, before: Hand | None = None
    ) -> int:
        """Return an object's body, made on first use; it is carried in `hand`, or collides with arm `before` alone."""
        key = (anchor, object_type, wider, hand, before)
        if key not in self._bodies:
            away = (0.0, 0.0, _AWAY_M, 0.0)
            kg = 0.0 if hand is None else CARRIED_KG
            body = bodies.object_body(self.client, object_type, away, _GREY, kg, wider)
            for link in self._gripper[hand] if hand else self._still[before] if before else ():
                p.setCollisionFilterPair(self.robot.id, body, link, -1, 0, physicsClientId=self.client)
            self._bodies[key] = body
        return self._bodies[key]

    def _park_all(self) -> None:
        for body in self._bodies.values():
            self._park(body)

    def _park(self, body: int) -> None:
        at, turn = (_APART_M * body, 0.0, _AWAY_M), (0.0, 0.0, 0.0, 1.0)
        p.resetBasePositionAndOrientation(body, at, turn, physicsClientId=self.client)

    # ---------------------------------------------------------------- configurations

    def set_arm(self, hand: Hand, joints: Sequence[float] | Floats) -> None:
        """Set an arm to seven joint values (rad), and move its carried object."""
        values = [[float(value)] for value in joints]
        p.resetJointStatesMultiDof(self.robot.id, self._arm_indices[hand], values, physicsClientId=self.client)
        if hand in self.carried:
            self._move_carried(hand)

    def set_base(self, world_T_base: Sequence[float] | Floats) -> None:
        """Put the base at a pose, and move the carried objects."""
        values = [[float(value)] for value in world_T_base]
        p.resetJointStatesMultiDof(self.robot.id, self._base_indices, values, physicsClientId=self.client)
        for hand in self.carried:
            self._move_carried(hand)

    def _move_carried(self, hand: Hand) -> None:
        item = self.carried[hand]
        x, y, z, theta = item.tool_T_object
        state = p.getLinkState(
            self.robot.id, self._tool_link[hand], computeForwardKinematics=True, physicsClientId=self.client
        )
        centre = (x, y, z + item.type.size_m[2] / 2.0)
        at = p.multiplyTransforms(state[4], state[5], centre, quaternion_xyzw(theta))
        p.resetBasePositionAndOrientation(item.body, *at, physicsClientId=self.client)

    def free(self, touching: frozenset[int] = frozenset()) -> bool:
        """Return whether nothing collides in the present configuration.

        Args:
            touching: Bodies that grippers and carried objects may touch.
        """
        p.performCollisionDetection(physicsClientId=self.client)
        for contact in p.getContactPoints(bodyA=self.robot.id, physicsClientId=self.client):
            if contact[8] < -PENETRATION_M and not (contact[2] in touching and self._is_gripper(contact[3])):
                return False
        for item in self.carried.values():
            for contact in p.getContactPoints(bodyA=item.body, physicsClientId=self.client):
                if contact[8] < -PENETRATION_M and contact[2] not in touching:
                    return False
        return True

    def touched(self) -> frozenset[str]:
        """Return the standing objects that the robot or a carried object collides with."""
        p.performCollisionDetection(physicsClientId=self.client)
        moving = [self.robot.id, *(item.body for item in self.carried.values())]
        met = {
            contact[2]
            for body in moving
            for contact in p.getContactPoints(bodyA=body, physicsClientId=self.client)
            if contact[8] < -PENETRATION_M
        }
        return frozenset(anchor for anchor, item in self.standing.items() if item.body in met)

    def _is_gripper(self, link: int) -> bool:
        return any(link in links for links in self._gripper.values())

    def clear(self, margin_m: float) -> bool:
        """Return whether robot and carried objects keep a distance to all standing objects."""
        moving = [self.robot.id, *(item.body for item in self.carried.values())]
        return not any(
            p.getClosestPoints(body, item.body, margin_m, physicsClientId=self.client)
            for item in self.standing.values()
            for body in moving
        )

    def ground(self) -> tuple[Standing, ...]:
        """Return the objects on the floor: tables, and objects that are on no table."""
        return tuple(
            item for item in self.standing.values() if item.type.shape == "table" or self.table_below(item) is None
        )

    def table_below(self, item: Standing) -> Standing | None:
        """Return the table on which an object stands, by its pose."""
        if item.type.shape == "table":
            return None
        for other in self.standing.values():
            if other.type.shape == "table" and self._stands_on(item, other):
                return other
        return None

    def _stands_on(self, item: Standing, table: Standing) -> bool:
        x, y, _ = compose2(inverse2(flat(table.world_T_object)), flat(item.world_T_object))
        level = abs(item.world_T_object[2] - table.world_T_object[2] - table.type.size_m[2]) <= RESTING_GAP_M
        return level and abs(x) <= table.type.size_m[0] / 2.0 and abs(y) <= table.type.size_m[1] / 2.0

    # ---------------------------------------------------------------- what if

    @contextlib.contextmanager
    def picked(self, hand: Hand, anchor: str, tool_T_object: Pose4) -> Iterator[None]:
        """Put a standing object into a hand during the context."""
        item = self.standing.pop(anchor)
        body = self._body(anchor, item.type, 0.0, hand)
        self._park(item.body)
        self.carried[hand] = Carried(hand, anchor, item.type, tool_T_object, body)
        try:
            yield
        finally:
            del self.carried[hand]
            self._park(body)
            bodies.set_pose(self.client, item.body, item.type, item.world_T_object)
            self.standing = {a: item if a == anchor else self.standing[a] for a in self._order(anchor)}

    @contextlib.contextmanager
    def placed(self, hand: Hand, world_T_object: Pose4) -> Iterator[int]:
        """Let a carried object stand at a pose during the context; yield its body."""
        carried = self.carried.pop(hand)
        body = self._body(carried.anchor, carried.type, 0.0, None)
        self._park(carried.body)
        bodies.set_pose(self.client, body, carried.type, world_T_object)
        try:
            yield body
        finally:
            self._park(body)
            self.carried[hand] = carried
            self._move_carried(hand)

    @contextlib.contextmanager
    def stand_in(self, object_type: ObjectType, wider_m: float) -> Iterator[int]:
        """Add a body of a type that is no believed object during the context; yield it, parked away from all others."""
        body = self._body("", object_type, wider_m, None)
        try:
            yield body
        finally:
            self._park(body)

    def meets(self, body: int) -> bool:
        """Return whether the robot or a carried object touches a body."""
        moving = [self.robot.id, *(item.body for item in self.carried.values())]
        return any(p.getClosestPoints(part, body, 0.0, physicsClientId=self.client) for part in moving)

    def _order(self, returned: str) -> list[str]:
        """Return the standing anchors and `returned`, in the belief's order."""
        return [a for a in self._belief.anchors if a in self.standing or a == returned]

    # ---------------------------------------------------------------- seeing

    def look_at(self, point_world: Vector3) -> tuple[float, float] | None:
        """Turn the optical axis through a point and return pan and tilt; beyond the limits return None, unturned."""
        pan, tilt = self.robot.look_at(point_world)
        before = self.robot.joints(HEAD)
        self.robot.set_joints(dict(zip(HEAD, (pan, tilt), strict=True)))
        position, rotation = self.robot.camera_pose()
        x, y, z = rotation.T @ (np.array(point_world) - position)
        if x <= 0.0 or math.hypot(y, z) > CENTRED * x:
            self.robot.set_joints(dict(zip(HEAD, before, strict=True)))
            return None
        return pan, tilt

    def camera_pose(self) -> tuple[Floats, Floats]:
        """Return the camera's position, shape (3,), and rotation world_R_camera, shape (3, 3); x is forward."""
        return self.robot.camera_pose()

    def unhidden(self, points_world: Floats) -> NDArray[np.bool_]:
        """Return the mask, shape (n,), of points (n, 3), world, that nothing hides from the camera."""
        return np.asarray(np.array(self.hits(points_world), dtype=np.int64) == -1)

    def hits(self, points_world: Floats) -> list[int]:
        """Return the first body between the camera and each of the points, shape (n, 3); -1 where there is none."""
        if not len(points_world):
            return []
        eye, _ = self.robot.camera_pose()
        away = points_world - eye
        starts = eye + away * (NEAREST_RAY_M / np.linalg.norm(away, axis=1, keepdims=True))
        found = p.rayTestBatch(starts.tolist(), points_world.tolist(), physicsClientId=self.client)
        return [hit[0] for hit in found]
