"""A12: the belief is printed as the paper prints it."""

import math

import pytest
from kit.papers import Handler, at_five_percent, seen_as, shipped
from kit.searches import TOP, TYPES, thing

from skolem.tools.words.belief_table import COLUMNS, belief_rows
from skolem.traces.messages import Detection, ObjectType, Pose4, Prior, PriorObject

CARTON = ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True)
BLUE_RGB = (0.08, 0.2, 0.64)
O1: Pose4 = (1.0, 0.1, TOP, 0.0)
O2: Pose4 = (1.2, 0.0, TOP, 0.0)
O3: Pose4 = (1.0, -0.3, TOP, 0.0)
O4: Pose4 = (0.1, 1.5, TOP, 0.0)


def of_type(anchor: str, kind: str, p: float, at: Pose4) -> PriorObject:
    """Return an object that is of a type with probability p after one right look, of three types told apart at 95 %."""
    odds = p / (1.0 - p) * 0.025 / 0.95
    before, other = odds / (1.0 + odds), "soda" if kind == "carton" else "bottle"
    told = thing(anchor, kind, at, sd_m=0.02)
    return told.model_copy(update={"type": {kind: before, other: 1.0 - before}, "sd_theta_rad": 1.8})


def start() -> Prior:
    """The robot stands before a table with three objects; a desk and a shelf are elsewhere."""
    tables = [
        thing("desk", "table", (0.0, -1.5, 0.0, 0.0), support=None),
        thing("shelf", "table", (0.0, 1.5, 0.0, 0.0), support=None),
    ]
    objects = [
        of_type("_o1_", "carton", 0.92, O1),
        of_type("_o2_", "soda", 0.80, O2),
        of_type("_o3_", "soda", 0.87, O3),
    ]
    noise = {"place_sd_m": 0.03, "grasp_sd_m": 0.001}
    prior = at_five_percent([*tables, *objects], regions=(), **noise)
    return prior.model_copy(update={"types": TYPES | {"carton": CARTON}})


def seen(at: Pose4, kind: str, rgb: tuple[float, float, float] = (0.08, 0.64, 0.08)) -> Detection:
    """Return a detection sure of one of three types."""
    likely = {name: (0.0 if name == kind else -40.0) for name in ("bottle", "carton", "soda")}
    return seen_as(at, rgb=rgb).model_copy(update={"type_log_likelihood": likely})


def rows(robot: Handler) -> dict[str, tuple[str, ...]]:
    """Return the printed rows by anchor, tables left out."""
    printed = belief_rows(robot.belief.snapshot(robot.step), shipped().vocabulary.meanings)
    return {row[0]: row[1:] for row in printed if row[0] not in ("table1", "shelf")}


DESK = ("table, 1.00", "(0.00, -1.50), low", "prior", "prior")


def test_the_printed_table_follows_the_example_through_its_five_moments() -> None:
    """ "Its belief state is": anchor, type d, pose d, color d, weight d, at each moment of the example."""
    robot = Handler(start())
    robot.see(seen(O1, "carton"), seen(O2, "soda"), seen(O3, "soda", BLUE_RGB))
    expected = {
        "desk": DESK,
        "_o1_": ("carton, .92", "(1.00, 0.10), low", "green, low", "prior"),
        "_o2_": ("soda, .80", "(1.20, 0.00), low", "green, low", "prior"),
        "_o3_": ("soda, .87", "(1.00, -0.30), low", "blue, low", "prior"),
    }
    assert rows(robot) == expected

    robot.pick("_o1_")
    robot.place("_o1_", "desk", (0.1, -1.4, 0.0))
    robot.pick("_o2_")
    robot.weigh(0.1)
    expected["_o1_"] = ("carton, .92", "(0.10, -1.40), med", "green, low", "prior")
    expected["_o2_"] = ("soda, .80", "in hand", "green, low", "100 g, low")
    assert rows(robot) == expected

    robot.see(seen(O4, "soda"))
    robot.see(seen(O4, "soda"))
    sure = 1.0 - 2.0 * (0.025 / 0.95) ** 2
    expected["_o4_"] = (f"soda, {sure:.2f}".replace("0.", "."), "(0.10, 1.50), low", "green, low", "prior")
    assert rows(robot) == expected

    robot.place("_o2_", "shelf", (-0.1, 1.4, 0.0))
    robot.pick("_o4_")
    robot.weigh(0.5)
    expected["_o2_"] = ("soda, .80", "(-0.10, 1.40), med", "green, low", "100 g, low")
    expected["_o4_"] = (expected["_o4_"][0], "in hand", "green, low", "500 g, low")
    assert rows(robot) == expected

    robot.place("_o4_", "desk", (-0.1, -1.4, 0.0))
    expected["_o4_"] = (expected["_o4_"][0], "(-0.10, -1.40), med", "green, low", "500 g, low")
    assert rows(robot) == expected
    assert robot.belief.prob_on("_o4_", "desk") > 0.9


def test_the_columns_are_those_of_the_paper() -> None:
    """ " 'd' stands for distribution in the column headings." """
    assert COLUMNS[1:] == ("type d", "pose d", "color d", "weight d")


@pytest.mark.parametrize(("sd_m", "word"), [(0.005, "low"), (0.03, "med"), (0.2, "high")])
def test_low_is_a_low_variance_and_means_well_known(sd_m: float, word: str) -> None:
    """ " 'Low' for low variance": the poorly known is not called low."""
    robot = Handler(at_five_percent([thing("o", "soda", O1, sd_m=sd_m)]))
    row = next(r for r in belief_rows(robot.belief.snapshot(0), shipped().vocabulary.meanings) if r[0] == "o")
    assert row[2] == f"(1.00, 0.10), {word}"
    assert math.sqrt(robot.belief.snapshot(0).objects["o"].covariance[0]) == pytest.approx(sd_m)
