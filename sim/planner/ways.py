"""Ways of doing an activity: their sweeps, their blockers, and the places where they leave room for an object."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.standing import Carried
from skolem.sim.robot import bodies
from skolem.sim.space import grasps
from skolem.traces.messages import Hand, ObjectType, Pick, Pose2, Pose4
from skolem.traces.messages.poses import Vector3

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

ROOM_M = 0.03  # around an object that is put down beside a way, since it lands a little beside its place
BESIDE_M = 0.6  # no object further than this from the line between base and target can block a way


@dataclass(frozen=True, slots=True)
class Sweep:
    """The part of a pick near the object: reach ends at the grasp, lift begins there; shapes (k, 7), (m, 7)."""

    hand: Hand
    reach: Floats
    lift: Floats
    tool_T_object: Pose4

    @classmethod
    def of(cls, pick: Pick) -> "Sweep":
        """Return the sweep of a planned pick."""
        return cls(pick.hand, np.array(pick.reach), np.array(pick.lift), pick.tool_T_object)


@dataclass(frozen=True, slots=True)
class Way:
    """One way of doing an activity.

    Attributes:
        anchor: The object or region of the activity.
        world_T_base: Pose of the base.
        target: Point to which the camera is turned, world.
        points: Points that must be seen, shape (n, 3), metres, world.
        sweep: Motion of the arm; None for a look.
        blockers: Anchors of the objects that block it, sorted.
    """

    anchor: str
    world_T_base: Pose2
    target: Vector3
    points: Floats
    sweep: Sweep | None
    blockers: tuple[str, ...] = ()


def touched(world: BelievedWorld, anchor: str, sweep: Sweep) -> frozenset[str]:
    """Return the graspable objects, except the target, that the arm touches in a sweep from the present pose."""
    met: set[str] = set()
    present = world.robot.arm(sweep.hand)
    for joints in sweep.reach:
        world.set_arm(sweep.hand, joints)
        met |= world.touched()
    with world.picked(sweep.hand, anchor, sweep.tool_T_object):
        for joints in sweep.lift:
            world.set_arm(sweep.hand, joints)
            met |= world.touched()
    world.set_arm(sweep.hand, present)
    return frozenset(name for name in met if world.standing[name].type.graspable and name != anchor)


def leaves_room(world: BelievedWorld, way: Way, carried: Carried, places: Floats) -> Mask:
    """Return the mask, shape (k,), of places where an object would not block a way.

    Args:
        world: The believed world; its robot is put at the base pose of the way.
        way: The way that must stay free.
        carried: The object to put down; it counts as a cylinder, a little wider than it is.
        places: Positions of the middle of its base face, shape (k, 3), metres, world.
    """
    free = np.ones(len(places), dtype=bool)
    near = np.flatnonzero(_distance(places[:, :2], way) <= BESIDE_M)
    kind = _round(carried.type)
    with world.emptied(carried.hand), world.stand_in(kind, ROOM_M) as body:

        def drop(in_the_way: Callable[[], bool]) -> None:
            nonlocal near
            bad = np.zeros(len(near), dtype=bool)
            for i, k in enumerate(near):
                bodies.set_pose(world.client, body, kind, (*places[k].tolist(), 0.0))
                bad[i] = in_the_way()
            free[near[bad]] = False
            near = near[~bad]

        world.reset(way.world_T_base)
        world.look_at(way.target)
        drop(lambda: body in world.hits(way.points))
        if way.sweep is not None:
            for joints in way.sweep.reach:
                world.set_arm(way.sweep.hand, joints)
                drop(lambda: world.meets(body))
            with world.picked(way.sweep.hand, way.anchor, way.sweep.tool_T_object):
                for joints in way.sweep.lift:
                    world.set_arm(way.sweep.hand, joints)
                    drop(lambda: world.meets(body))
    world.reset()
    return free


def _round(thing: ObjectType) -> ObjectType:
    width = 2.0 * grasps.widest_half(thing)
    return ObjectType(shape="cylinder", size_m=(width, width, thing.size_m[2]), graspable=True)


def _distance(points: Floats, way: Way) -> Floats:
    """Return the distance of points, shape (k, 2), from the line between base and target, shape (k,)."""
    start, end = np.array(way.world_T_base[:2]), np.array(way.target[:2])
    along = end - start
    t = np.clip((points - start) @ along / max(float(along @ along), 1e-9), 0.0, 1.0)
    return np.asarray(np.hypot(*(points - start - t[:, None] * along).T))
