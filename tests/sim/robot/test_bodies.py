from collections.abc import Iterator

import pytest

from skolem.sim.robot import bodies
from skolem.sim.robot.bullet import p
from skolem.traces.messages import ObjectType, Pose4

TABLE = ObjectType(shape="table", size_m=(0.8, 1.2, 0.68), graspable=False)
CAN = ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True)
BOX = ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True)
WHITE = (1.0, 1.0, 1.0, 1.0)
MARGIN_M = 0.003  # PyBullet's bounds are a little wider than the shape


@pytest.fixture
def client() -> Iterator[int]:
    client = bodies.connect()
    yield client
    bodies.disconnect(client)


@pytest.mark.parametrize("object_type", [TABLE, CAN, BOX], ids=["table", "can", "box"])
def test_the_origin_is_the_centre_of_the_base_face(client: int, object_type: ObjectType) -> None:
    body = bodies.object_body(client, object_type, (1.0, 2.0, 0.5, 0.0), WHITE, 0.2)
    low, high = p.getAABB(body, physicsClientId=client)
    x, y, z = object_type.size_m
    assert low == pytest.approx((1.0 - x / 2.0, 2.0 - y / 2.0, 0.5), abs=MARGIN_M)
    assert high == pytest.approx((1.0 + x / 2.0, 2.0 + y / 2.0, 0.5 + z), abs=MARGIN_M)


@pytest.mark.parametrize("object_type", [TABLE, CAN, BOX], ids=["table", "can", "box"])
def test_a_pose_set_is_the_pose_read(client: int, object_type: ObjectType) -> None:
    body = bodies.object_body(client, object_type, (0.0, 0.0, 0.0, 0.0), WHITE, 0.2)
    there: Pose4 = (0.3, -0.4, 0.68, 1.2)
    bodies.set_pose(client, body, object_type, there)
    assert bodies.pose(client, body, object_type) == pytest.approx(there, abs=1e-9)


def test_inflation_widens_the_footprint_and_leaves_the_height(client: int) -> None:
    body = bodies.object_body(client, CAN, (0.0, 0.0, 0.0, 0.0), WHITE, 0.0, inflate_m=0.05)
    low, high = p.getAABB(body, physicsClientId=client)
    assert high[0] - low[0] == pytest.approx(0.166, abs=2.0 * MARGIN_M)
    assert high[2] - low[2] == pytest.approx(0.115, abs=2.0 * MARGIN_M)


def test_a_can_stays_where_it_is_put_on_a_table(client: int) -> None:
    bodies.floor(client)
    bodies.table(client, TABLE.size_m, (1.0, 0.0, 0.0, 0.3))
    at: Pose4 = (0.8, 0.1, 0.68, 0.5)
    body = bodies.object_body(client, CAN, at, WHITE, 0.35)
    for _ in range(240):
        p.stepSimulation(physicsClientId=client)
    assert bodies.pose(client, body, CAN) == pytest.approx(at, abs=1e-3)
