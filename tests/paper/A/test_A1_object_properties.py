"""A1: what is believed is ordered by objects, and of each object by independent properties."""

import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, denotes, seen_as

from skolem.traces.messages import Detection, ObjectBelief

PROPERTIES = {
    "type": ("type",),
    "pose": ("world_T_object", "covariance"),
    "colour": ("colour", "colour_seen"),
    "weight": ("log_weight", "weighed"),
}


def after(detection: Detection) -> ObjectBelief:
    """Return what is believed of the can after one look."""
    robot = Handler(at_five_percent([can()]))
    robot.see(detection)
    return robot.belief.snapshot(0).objects["can1"]


def test_every_anchor_has_a_type_a_pose_a_colour_and_a_weight() -> None:
    """ "It is organized in terms of objects and probability distributions over their properties." """
    belief = Handler(at_five_percent([can("can1"), can("can2", world_T_object=(1.1, 0.2, 0.7, 0.0))])).belief
    said = belief.snapshot(0).model_dump()["objects"]
    assert tuple(said) == belief.anchors() == ("table1", "can1", "can2")
    for believed in said.values():
        assert all(believed[field] is not None for fields in PROPERTIES.values() for field in fields)


@pytest.mark.parametrize(
    ("changed", "detection"),
    [
        ("type", seen_as(STANDS, kind="bottle")),
        ("pose", seen_as((1.01, -0.02, 0.7, 0.0))),
        ("colour", seen_as(STANDS, rgb=(0.6, 0.08, 0.08))),
    ],
)
def test_an_observation_of_one_property_leaves_the_other_three_as_they_are(changed: str, detection: Detection) -> None:
    """ "Rigid objects with distributions over properties: type, pose, color, weight." """
    one, other = after(seen_as(STANDS)).model_dump(), after(detection).model_dump()
    differing = {name for name, fields in PROPERTIES.items() if any(one[f] != other[f] for f in fields)}
    assert differing == {changed}


def test_properties_of_an_object_count_as_independent() -> None:
    """ "Making strong independence assumptions." """
    robot = Handler(at_five_percent([can(soda=0.7)]))
    apart = [denotes(f"lambda x. {word}(x)", robot.belief)["can1"] for word in ("Soda", "Green", "Heavy")]
    exists = robot.belief.prob_exists("can1")
    expected = apart[0] * apart[1] * apart[2] / exists**2
    assert denotes("lambda x. Soda(x) & Green(x) & Heavy(x)", robot.belief)["can1"] == pytest.approx(expected)
