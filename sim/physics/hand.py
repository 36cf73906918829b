"""Grasping with a hand: find an object between the fingers, hold it, release it, and measure its weight.

A firm grasp is a fixed constraint between palm and object, with collisions between robot and object off. With contacts
on, they act against the constraint, and the force at the wrist is wrong.
"""

import numpy as np
from numpy.typing import NDArray

from skolem.sim.physics.world import Grasp, World
from skolem.sim.robot.bullet import p
from skolem.sim.robot.rotations import rotation
from skolem.traces.messages import GRAVITY, Hand

GRASP_FORCE = 500.0  # N, greatest force of the constraint
MIN_GAP_M = 0.01  # fingers closer than this hold nothing
CONTACT_M = 0.001  # the solver keeps touching bodies apart by up to a tenth of this
_PALM, _WRIST = "gripper_palm_link", "wrist_roll_joint"
_SIDES = ("l_finger", "r_finger")


def between_fingers(world: World, hand: Hand) -> str | None:
    """Return the object that both fingers of a hand press on, or None; the first by name if there are several."""
    if world.robot.gripper_gap(hand) < MIN_GAP_M:
        return None
    for name, placed in world.placed.items():
        if placed.kind.graspable and all(_presses(world, hand, side, placed.body) for side in _SIDES):
            return name
    return None


def _presses(world: World, hand: Hand, side: str, body: int) -> bool:
    """Return whether a finger, or its tip, touches a body."""
    links = [world.robot.link[f"{hand[0]}_gripper_{side}{part}_link"] for part in ("", "_tip")]
    contacts = p.getContactPoints(bodyA=world.robot.id, bodyB=body, physicsClientId=world.client)
    return any(contact[3] in links and contact[8] < CONTACT_M for contact in contacts)


def attach(world: World, hand: Hand, thing_id: str) -> None:
    """Hold an object firmly at its present pose in the hand."""
    body, palm = world.placed[thing_id].body, world.robot.link[f"{hand[0]}_{_PALM}"]
    centre = p.getBasePositionAndOrientation(body, physicsClientId=world.client)
    _set_collisions(world, body, on=False)
    # createConstraint takes poses in the frame of the link's centre of mass, [0:2], not in the link's frame, [4:6]
    inertial = p.getLinkState(world.robot.id, palm, computeForwardKinematics=True, physicsClientId=world.client)[:2]
    at, turn = p.multiplyTransforms(*p.invertTransform(*inertial), *centre)
    constraint = p.createConstraint(
        world.robot.id,
        palm,
        body,
        -1,
        p.JOINT_FIXED,
        (0.0, 0.0, 0.0),
        at,
        (0.0, 0.0, 0.0),
        turn,
        (0.0, 0.0, 0.0, 1.0),
        physicsClientId=world.client,
    )
    p.changeConstraint(constraint, maxForce=GRASP_FORCE, physicsClientId=world.client)
    position, quaternion = p.multiplyTransforms(*p.invertTransform(*world.robot.tool_pose(hand)), *centre)
    world.grasps[hand] = Grasp(thing_id, constraint, position, quaternion)


def detach(world: World, hand: Hand) -> None:
    """Release a held object to contacts and gravity."""
    grasp = world.grasps.pop(hand)
    p.removeConstraint(grasp.constraint, physicsClientId=world.client)
    _set_collisions(world, world.placed[grasp.id].body, on=True)


def _set_collisions(world: World, body: int, on: bool) -> None:
    for link in sorted(world.robot.collision_links().values()):
        p.setCollisionFilterPair(world.robot.id, body, link, -1, int(on), physicsClientId=world.client)


def held_touches(world: World, hand: Hand) -> bool:
    """Return whether the object in a hand touches another body, such as the table it is lowered on."""
    body = world.placed[world.grasps[hand].id].body
    contacts = p.getContactPoints(bodyA=body, physicsClientId=world.client)
    return any(contact[2] != world.robot.id and contact[8] < CONTACT_M for contact in contacts)


def enable_wrist_sensor(world: World, hand: Hand) -> None:
    """Make the physics compute the reaction at the wrist of a hand."""
    joint = world.robot.joint[f"{hand[0]}_{_WRIST}"]
    p.enableJointForceTorqueSensor(world.robot.id, joint, True, physicsClientId=world.client)


def wrist_force(world: World, hand: Hand) -> NDArray[np.float64]:
    """Return the force at the wrist after a physics step without the hand's weight, shape (3,), newtons, base frame.

    At rest the hand's weight is the sum of the masses beyond the wrist times gravity, in every pose.
    """
    joint = world.robot.joint[f"{hand[0]}_{_WRIST}"]
    reaction = p.getJointState(world.robot.id, joint, physicsClientId=world.client)[2][:3]
    turn = p.getLinkState(world.robot.id, joint, computeForwardKinematics=True, physicsClientId=world.client)[5]
    world_R_link = np.reshape(p.getMatrixFromQuaternion(turn), (3, 3))
    force_base = rotation(-world.robot.base()[2]) @ world_R_link @ reaction
    return np.asarray(-force_base + np.array([0.0, 0.0, hand_kg(world, hand) * GRAVITY]))


def hand_kg(world: World, hand: Hand) -> float:
    """Return the mass of all links beyond the wrist, kg."""
    wrist = world.robot.link[f"{hand[0]}_wrist_roll_link"]
    beyond = {wrist}
    total = 0.0
    for index in range(p.getNumJoints(world.robot.id, physicsClientId=world.client)):
        if index in beyond or p.getJointInfo(world.robot.id, index, physicsClientId=world.client)[16] in beyond:
            beyond.add(index)
            total += p.getDynamicsInfo(world.robot.id, index, physicsClientId=world.client)[0]
    return total
