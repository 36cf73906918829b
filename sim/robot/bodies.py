"""Physics clients, and the bodies in them besides the robot: floor, tables, graspable objects.

A body's pose is that of its type: origin at the centre of the base face, z up. PyBullet's origin is the centre of mass,
so `set_pose` and `pose` shift by half the height of the type.
"""

from skolem.sim.robot.bullet import p
from skolem.traces.messages import GRAVITY, ObjectType, Pose4
from skolem.traces.messages.poses import Quaternion, Vector3, heading, quaternion_xyzw

Rgba = tuple[float, float, float, float]

WOOD: Rgba = (0.65, 0.50, 0.35, 1.0)
STONE: Rgba = (0.80, 0.80, 0.80, 1.0)
TOP_THICKNESS_M, LEG_WIDTH_M, LEG_INSET_M = 0.04, 0.04, 0.03  # of every table
FLOOR_HALF_M: Vector3 = (10.0, 10.0, 0.01)
FLOOR_GAP_M = 0.001  # keeps the robot's wheels out of contact with a floor that carries no weight
LATERAL_FRICTION, SPINNING_FRICTION, ROLLING_FRICTION = 1.0, 0.002, 0.0005  # a can that neither slides nor rolls away


def connect(gravity: bool = True) -> int:
    """Open a headless physics client with a fixed order of contacts, with or without gravity."""
    client: int = p.connect(p.DIRECT)
    p.setPhysicsEngineParameter(deterministicOverlappingPairs=1, physicsClientId=client)
    if gravity:
        p.setGravity(0.0, 0.0, -GRAVITY, physicsClientId=client)
    return client


def disconnect(client: int) -> None:
    """Close a client with all its bodies."""
    p.disconnect(physicsClientId=client)


def floor(client: int, rgba: Rgba = STONE) -> int:
    """Add a slab whose top is just below z = 0 and return its body."""
    below = (0.0, 0.0, -FLOOR_HALF_M[2] - FLOOR_GAP_M, 0.0)
    return _boxes(client, [FLOOR_HALF_M], [(0.0, 0.0, 0.0)], below, rgba)


def table(client: int, size_m: Vector3, world_T_table: Pose4, rgba: Rgba = WOOD, inflate_m: float = 0.0) -> int:
    """Add a top with four legs and return its body; `size_m` is (depth, width, height of the top surface)."""
    depth, width, height = size_m[0] + 2.0 * inflate_m, size_m[1] + 2.0 * inflate_m, size_m[2]
    top = (depth / 2.0, width / 2.0, TOP_THICKNESS_M / 2.0)
    leg = (LEG_WIDTH_M / 2.0, LEG_WIDTH_M / 2.0, (height - TOP_THICKNESS_M) / 2.0)
    x, y = depth / 2.0 - LEG_INSET_M, width / 2.0 - LEG_INSET_M
    feet = [(a * x, b * y, leg[2]) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    centres = [(0.0, 0.0, height - TOP_THICKNESS_M / 2.0), *feet]
    return _boxes(client, [top, leg, leg, leg, leg], centres, world_T_table, rgba)


def object_body(
    client: int, object_type: ObjectType, world_T_object: Pose4, rgba: Rgba, kg: float, inflate_m: float = 0.0
) -> int:
    """Add a body of a type and return it.

    Args:
        client: Physics client.
        object_type: Shape and size; a table ignores `kg` and never moves.
        world_T_object: Pose of the centre of the base face.
        rgba: Colour, each 0..1.
        kg: Mass; 0 for a body that never moves.
        inflate_m: Added to the footprint on every side, not to the height.
    """
    if object_type.shape == "table":
        return table(client, object_type.size_m, world_T_object, rgba, inflate_m)
    x, y, z = (object_type.size_m[0] / 2.0 + inflate_m, object_type.size_m[1] / 2.0 + inflate_m, object_type.size_m[2])
    if object_type.shape == "cylinder":
        shape = p.createCollisionShape(p.GEOM_CYLINDER, radius=x, height=z, physicsClientId=client)
        skin = p.createVisualShape(p.GEOM_CYLINDER, radius=x, length=z, rgbaColor=rgba, physicsClientId=client)
    else:
        half = (x, y, z / 2.0)
        shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=half, physicsClientId=client)
        skin = p.createVisualShape(p.GEOM_BOX, halfExtents=half, rgbaColor=rgba, physicsClientId=client)
    body: int = p.createMultiBody(kg, shape, skin, physicsClientId=client)
    _set_friction(client, body)
    set_pose(client, body, object_type, world_T_object)
    return body


def set_pose(client: int, body: int, object_type: ObjectType, world_T_object: Pose4) -> None:
    """Put the centre of the base face of a body of the type at a pose, at rest."""
    x, y, z, theta = world_T_object
    centre = (x, y, z + _centre_height(object_type))
    p.resetBasePositionAndOrientation(body, centre, quaternion_xyzw(theta), physicsClientId=client)


def pose(client: int, body: int, object_type: ObjectType) -> Pose4:
    """Return the pose of the centre of the base face of an upright body of the type."""
    (x, y, z), turn = full_pose(client, body)
    return (x, y, z - _centre_height(object_type), heading(turn))


def full_pose(client: int, body: int) -> tuple[Vector3, Quaternion]:
    """Return the position of a body's centre and its orientation (xyzw), upright or not."""
    position, turn = p.getBasePositionAndOrientation(body, physicsClientId=client)
    return tuple(position), tuple(turn)


def _centre_height(object_type: ObjectType) -> float:
    """Return the height of PyBullet's origin above the base face of a body of the type, metres."""
    return 0.0 if object_type.shape == "table" else object_type.size_m[2] / 2.0


def _set_friction(client: int, body: int) -> None:
    p.changeDynamics(
        body,
        -1,
        lateralFriction=LATERAL_FRICTION,
        spinningFriction=SPINNING_FRICTION,
        rollingFriction=ROLLING_FRICTION,
        physicsClientId=client,
    )


def _boxes(client: int, halves: list[Vector3], centres: list[Vector3], world_T_body: Pose4, rgba: Rgba) -> int:
    """Add an immovable body made of boxes; half extents and centres in the body's frame."""
    kinds = [p.GEOM_BOX] * len(halves)
    shape = p.createCollisionShapeArray(
        shapeTypes=kinds, halfExtents=halves, collisionFramePositions=centres, physicsClientId=client
    )
    skin = p.createVisualShapeArray(
        shapeTypes=kinds,
        halfExtents=halves,
        visualFramePositions=centres,
        rgbaColors=[rgba] * len(halves),
        physicsClientId=client,
    )
    turn = quaternion_xyzw(world_T_body[3])
    body: int = p.createMultiBody(0.0, shape, skin, world_T_body[:3], turn, physicsClientId=client)
    return body
