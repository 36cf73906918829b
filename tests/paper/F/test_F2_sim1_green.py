"""F2: the first simulation: three sodas on three tables, existence known, colours not; a green one onto table1.

The figures over 500 seeds and with the physics come from `skolem sweep` (docs/results.md).
"""

import math

import numpy as np
import pytest
from kit.runs import Run, over, with_physics
from scipy.spatial.transform import Rotation

from skolem.traces.messages import DepthView, Pose2, TrueObject

SEEDS = range(6)
HALF_SODA_M = 0.06  # from its base to its middle


def assert_rows(run: Run) -> None:
    """Assert what the paper tells of this execution."""
    looked = [name for name in run.named("LookAt") if name.startswith("soda")]
    assert list(dict.fromkeys(looked)) == ["sodaE", "sodaB", "sodaC"]
    for name, popped, after in zip(("sodaE", "sodaB"), run.given_up(), ("sodaB", "sodaC"), strict=False):
        assert run.actions[popped.step - 1].args == (name,)
        assert any(fluent.startswith(f"b(den(e1,{name}),") for fluent in popped.false_fluents)
        assert run.top_plans()[popped.step] == (f"ExamineObj(e1, {after})", f"Place({after}, table1)")
    assert len(run.given_up()) >= 2
    assert run.named("Pick") == ["sodaC"]
    pick, place = run.where("Pick(sodaC)"), run.where("Place(sodaC, table1)")
    assert any(row.startswith("Move(place(sodaC,table1") for row in run.operators[pick:place])
    assert (run.achieved, run.verdict.true, run.verdict.witness) == (True, True, "sodaC")


def in_view(view: DepthView, world_T_base: Pose2, thing: TrueObject) -> bool:
    """Return whether the middle of a soda lies within a picture."""
    x, y, theta = world_T_base
    base_R_world = Rotation.from_euler("z", -theta).as_matrix()
    point_base = base_R_world @ (np.array(thing.world_T_object[:3]) - (x, y, -HALF_SODA_M))
    camera_R_base = Rotation.from_quat(view.base_T_camera[3:]).as_matrix().T
    forward, left, up = camera_R_base @ (point_base - view.base_T_camera[:3])
    half = math.tan(view.fovy_rad / 2.0)
    return bool(forward > 0 and abs(up) <= half * forward and abs(left) <= half * view.columns / view.rows * forward)


def seen_at_once(run: Run) -> list[set[str]]:
    """Return, per look before anything is moved, the sodas within the picture."""
    looks = enumerate(run.observations[: run.where("Pick(")])
    return [
        {t.id for t in run.truths[i + 1].objects if t.type == "soda" and in_view(o.view, run.truths[i].world_T_base, t)}
        for i, o in looks
        if o.view is not None
    ]


def assert_one_at_a_time(run: Run) -> None:
    """Assert that no picture shows two sodas, and that each is in one."""
    pictures = seen_at_once(run)
    assert max(map(len, pictures)) == 1
    assert set.union(*pictures) == {"sodaE", "sodaB", "sodaC"}


def test_there_is_at_most_one_of_them_in_view() -> None:
    """ "The robot's view of the world is such that it can see at most one of the objects at a time"."""
    for run in over("sim1_green", SEEDS):
        assert_one_at_a_time(run)


@pytest.mark.physics
def test_there_is_at_most_one_of_them_in_view_with_the_physics() -> None:
    """ "The robot's view of the world is such that it can see at most one of the objects at a time"."""
    assert_one_at_a_time(with_physics("sim1_green"))


def test_the_sodas_are_looked_at_in_order_and_the_stack_is_popped_after_each_disappointment() -> None:
    """ "Discovers that sodaB is blue, and pops the plan stack once more"."""
    for run in over("sim1_green", SEEDS):
        assert_rows(run)


def test_the_first_plan_is_to_find_out_whether_the_soda_that_stands_there_already_is_green() -> None:
    """ "The robot plans to determine that the object sodaE satisfies the denoting expression"."""
    for run in over("sim1_green", SEEDS):
        assert run.decisions[0].plan[0] == "ExamineObj(e1, sodaE)"
        assert run.known()[-3:] == ("sodaE", "sodaB", "sodaC")
        assert not any(run.beliefs[0].objects[name].colour_seen for name in run.known())


@pytest.mark.physics
def test_with_the_physics() -> None:
    """ "Formulates and executes plans for picking up the object, moving, and placing it in the target region"."""
    assert_rows(with_physics("sim1_green"))
