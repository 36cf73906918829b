"""The first eye: the whole run is in its picture, wherever it is, and the robot hides as little as can be."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from kit.recordings import recorded
from kit.views import eye_of
from numpy.typing import NDArray
from rerun.chunk import RrdReader

from skolem.tools.view.viewing import pr2_model
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Belief, ObjectType, Prior, TrueObject, TrueState
from skolem.traces.scene.eye import VIEW_PX, Eye, framing
from skolem.traces.scene.recording import Scene, convert
from skolem.traces.scene.shapes import Xyz, point_on
from skolem.traces.scene.stage import Stage

FAR = (
    "robot.base.x=4.0",
    "robot.base.y=4.0",
    "world.0.at=[5.3, 4.0, 0.0]",
    "world.1.at=[4.0, 2.4, -1.5707963]",
    "world.2.at=[4.0, 5.6, 1.5707963]",
)
TOP_M = 1.6  # of the robot's head with the torso as high as in the scenarios
HALF_BASE_M = 0.33  # half as wide is the PR2's base
TABLE = ObjectType(shape="table", size_m=(0.8, 1.2, 0.68), graspable=False)


def in_picture(eye: Eye, points: list[Xyz]) -> bool:
    seen = eye.pixels(points)[:, :2]
    ahead = (np.array(points) - eye.at) @ np.subtract(eye.target, eye.at)
    return bool(((seen >= 0.0) & (seen <= VIEW_PX)).all() and (ahead > 0.0).all())


@pytest.mark.parametrize(("name", "overrides"), [("sim1_green", FAR), ("sim1_green", ()), ("occluded", ())])
def test_the_robot_and_all_true_bodies_are_in_the_picture(name: str, overrides: tuple[str, ...]) -> None:
    trace = Trace(recorded(name, overrides=overrides))
    eye, types = eye_of(trace), next(trace.of(Prior)).types
    for state in trace.of(TrueState):
        x, y, _ = state.world_T_base
        assert in_picture(eye, [(x, y, 0.0), (x, y, TOP_M)]), state.step
        for item in state.objects:
            u, v, height = (side / 2.0 for side in types[item.type].size_m)
            corners = [(i * u, j * v, k) for i in (-1, 1) for j in (-1, 1) for k in (0.0, 2.0 * height)]
            assert in_picture(eye, [point_on(item.world_T_object, corner) for corner in corners]), item.id


def test_the_recording_opens_with_that_eye(tmp_path: Path) -> None:
    trace = Trace(recorded("sim1_green", overrides=FAR))
    convert(trace, tmp_path / "far.rrd", pr2_model())
    reader, eye, found = RrdReader(tmp_path / "far.rrd"), eye_of(trace), []
    for layout in reader.blueprints():
        for chunk in reader.stream(store=layout).to_chunks():
            rows = chunk.to_record_batch()
            found += [rows.column(n).to_pylist() for n in rows.schema.names if n == "EyeControls3D:position"]
    assert found
    assert all(rows[-1][0] == pytest.approx(eye.at, abs=1e-5) for rows in found)


# ---------------------------------------------------------------- by hand: a robot that is a mast


def mast(belief: Belief) -> list[tuple[Xyz, Xyz]]:
    x, y, _ = belief.world_T_base
    return [((x, y, 0.0), (x, y, 1.5))]


def stage_of(belief: Belief, *bases: tuple[float, float, float], turn: float = 0.0, shift: float = 0.0) -> Stage:
    """Return a stage with tables before and beside a robot that is at these places, all of it turned and moved."""

    def there(x: float, y: float, theta: float) -> tuple[float, float, float]:
        return (
            shift + math.cos(turn) * x - math.sin(turn) * y,
            shift + math.sin(turn) * x + math.cos(turn) * y,
            theta + turn,
        )

    stage = Stage(mast)
    for step, base in enumerate(bases):
        tables = []
        for name, place in (("front", (1.3, 0.0, 0.0)), ("side", (0.0, -1.6, -math.pi / 2.0))):
            x, y, theta = there(*place)
            tables.append(TrueObject(id=name, type="table", world_T_object=(x, y, 0.0, theta), hsv=(0, 0, 0), kg=9.0))
        state = TrueState(step=step, world_T_base=there(*base), objects=tuple(tables), sha256="")
        stage.state(state, {"table": TABLE})
        stage.believed(belief.model_copy(update={"step": step}), {"table": TABLE})
    return stage


@pytest.fixture(scope="module")
def belief() -> Belief:
    return next(Trace(recorded("sim1_green")).of(Belief))


def test_the_eye_goes_with_the_scene(belief: Belief) -> None:
    bases, points = ((0.0, 0.0, 0.0), (0.3, -0.4, 0.2)), [(0.0, 0.0, 1.5), (1.3, 0.0, 0.68), (0.0, -1.6, 0.0)]
    one, other = stage_of(belief, *bases).eye(), stage_of(belief, *bases, turn=2.0, shift=4.0).eye()
    assert one is not None
    assert other is not None
    moved = [
        (4.0 + math.cos(2.0) * x - math.sin(2.0) * y, 4.0 + math.sin(2.0) * x + math.cos(2.0) * y, z)
        for x, y, z in points
    ]
    a_pixel = 1.0 + 400.0 * 0.01  # places on limbs are rounded to the centimetre, at about 400 pixels a metre
    assert other.pixels(moved)[:, :2] == pytest.approx(one.pixels(points)[:, :2], abs=a_pixel)


@pytest.mark.parametrize("beyond", [(2.2, -0.3, math.pi), (2.4, 0.0, math.pi), (0.4, 0.3, 0.0)])
def test_a_robot_that_stands_around_a_table_does_not_hide_it(
    belief: Belief, beyond: tuple[float, float, float]
) -> None:
    eye = stage_of(belief, (0.0, 0.0, 0.0), beyond).eye()
    assert eye is not None
    heights = np.linspace(0.0, TOP_M, 50)
    for (x, y, _), aside in itertools.product(((0.0, 0.0, 0.0), beyond), (-0.4, 0.0, 0.4)):
        robot, spot = np.column_stack((np.full(50, x), np.full(50, y), heights)), np.array((1.3, aside, 0.68))
        assert nearest_on_line(np.array(eye.at), spot, robot) > HALF_BASE_M


def nearest_on_line(start: NDArray[np.float64], end: NDArray[np.float64], points: NDArray[np.float64]) -> float:
    """Return how near any of the points, shape (n, 3), comes to the line between two others."""
    along = end - start
    share = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
    return float(np.linalg.norm(points - start - share[:, None] * along, axis=1).min())


def test_of_a_run_that_goes_on_the_places_before_the_tables_are_in_the_picture(belief: Belief) -> None:
    eye = stage_of(belief, (0.0, 0.0, 0.0)).eye(going_on=True)
    assert eye is not None
    for x, y in ((0.4, 0.0), (0.0, -0.7)):
        assert in_picture(eye, [(x, y, 0.0), (x, y, 1.5)])


def test_a_run_that_goes_on_is_looked_at_from_its_first_belief_on() -> None:
    trace = Trace(recorded("sim1_green", overrides=FAR))
    scene, eyes = Scene(rr.RecordingStream("test"), pr2_model()), []
    for message in trace.messages(*scene.topics):
        scene.take(message)
        eyes.append((message.topic, scene.eye))
    first = [topic for topic, _ in eyes].index("/belief")
    assert {eye for _, eye in eyes[:first]} == {None}
    assert len({eye for _, eye in eyes[first:]}) == 1
    assert eyes[-1][1] is not None


def test_an_empty_stage_has_no_eye() -> None:
    assert Stage(mast).eye() is None


@pytest.mark.parametrize("azimuth", [0.0, 1.0, 2.5, -2.0])
def test_the_framing_eye_is_as_near_as_it_can_be(azimuth: float) -> None:
    points = np.random.default_rng(3).normal(size=(30, 3)) * (1.0, 2.0, 0.5) + (4.0, 4.0, 1.0)
    eye = framing(np.column_stack((points, np.zeros(30))), azimuth, 0.6)
    pixels = eye.pixels([(x, y, z) for x, y, z in points.tolist()])[:, :2]
    free = np.minimum(pixels, VIEW_PX - pixels).min(axis=0) / VIEW_PX
    assert free.min() == pytest.approx(0.03)  # on both sides, and then there is no more room
