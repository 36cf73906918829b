"""Labels in the drawn world: what they say, and that as seen from the first eye none covers another or an object."""

import itertools
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from kit.recordings import recorded
from kit.views import eye_of
from rerun.chunk import RrdReader

from skolem.tools.view.viewing import pr2_model
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Belief, Denotation, HsvBelief, ObjectBelief, ObjectType, Prior
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.scene.eye import Eye
from skolem.traces.scene.labels import text_of, two_digits
from skolem.traces.scene.layout import half_size
from skolem.traces.scene.recording import convert
from skolem.traces.scene.robot import Robot
from skolem.traces.scene.rows import Rows

CAN = ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.12), graspable=True)
TABLE = ObjectType(shape="table", size_m=(0.8, 1.2, 0.68), graspable=False)
COMPONENTS = ("Points3D:labels", "Points3D:positions")
TEXT_PX = 2.0  # the viewer writes so far below a label's point


def known(**changes: object) -> ObjectBelief:
    before = ObjectBelief(
        exists=0.99,
        type={"bottle": 0.13, "can": 0.87},
        world_T_object=(1.0, 0.0, 0.68, 0.5),
        covariance=(4e-4, 1e-4, 0.0, 1e-4, 0.0, 0.01),
        colour=HsvBelief(mean=(0.33, 0.9, 0.8), variance=(0.001, 0.01, 0.01)),
        log_weight=(-1.2, 0.36),
    )
    return before.model_copy(update=changes)


def test_a_label_says_type_colour_and_whether_it_is_what_is_meant() -> None:
    meant = Denotation(step=0, probability={"e1": {"o2": 0.4142}})
    assert text_of("o2", known(colour_seen=True), CAN, meant) == "o2: can .87, green, meant .41"


def test_a_label_does_not_tell_a_colour_nobody_has_seen_or_a_value_nobody_recorded() -> None:
    assert text_of("o2", known(), CAN, None) == "o2: can .87"


def test_furniture_is_labelled_with_its_name_alone() -> None:
    assert text_of("desk", known(type={"table": 1.0}), TABLE, None) == "desk"


def test_a_region_tells_where_things_can_hide_apart_from_what_is_known(tmp_path: Path) -> None:
    """Two numbers: once all places have been seen, contents are still unknown where readings are not explained."""
    trace, recording = Trace(recorded("sim3_unknown")), tmp_path / "run.rrd"
    eye = eye_of(trace)
    convert(trace, recording, pr2_model())
    labels = labels_of(recording, eye)
    for step, belief in enumerate(trace.of(Belief)):
        told = {text for text in labels[step] if text.startswith("_reg")}
        assert told == {
            f"{name}: {100.0 * region.hidden:.0f} % unsearched, known {two_digits(region.seen)}"
            for name, region in belief.regions.items()
        }


Box = tuple[float, float, float, float]


def labels_of(recording: Path, eye: Eye) -> dict[int, dict[str, Box]]:
    """Return the rectangle of each label by step, in pixels: left, top, right, bottom."""
    found: dict[int, dict[str, Box]] = defaultdict(dict)
    for chunk in RrdReader(recording).stream().to_chunks():
        if chunk.entity_path.endswith("/label") and "step" in chunk.timeline_names:
            rows = chunk.to_record_batch()
            steps, texts, places = (rows.column(n).to_pylist() for n in ("step", *COMPONENTS))
            for step, (text,), place in zip(steps, texts, places, strict=True):
                column, row, _ = eye.pixels(place)[0]
                wide, high = half_size(text)
                top = row - TEXT_PX
                found[step][text] = (column - wide, top, column + wide, top + 2.0 * high)
    return found


@pytest.mark.parametrize(("name", "step"), [("illustrative", 0), ("sim1_green", 0), ("sim3_unknown", 2)])
def test_no_label_covers_another_or_an_object(name: str, step: int, tmp_path: Path) -> None:
    trace = Trace(recorded(name))
    eye = eye_of(trace)
    convert(trace, tmp_path / "run.rrd", pr2_model())
    boxes = labels_of(tmp_path / "run.rrd", eye)[step]
    belief, types = list(trace.of(Belief))[step], next(trace.of(Prior)).types
    assert len(boxes) >= len(belief.anchors) + len(belief.regions)
    assert not [pair for pair in itertools.combinations(boxes, 2) if overlap(*(boxes[text] for text in pair))]
    for anchor in belief.anchors:
        kind, (x, y, z, _) = types[likeliest(belief.objects[anchor].type)], belief.objects[anchor].world_T_object
        if kind.shape != "table":
            column, row, _ = eye.pixels([(x, y, z + kind.size_m[2] / 2.0)])[0]
            middle = (column, row, column, row)
            assert not [text for text, box in boxes.items() if overlap(box, middle)], anchor


@pytest.mark.parametrize(("name", "seed"), [("illustrative", 0), ("sim1_green", 1), ("sim3_unknown", 1), ("behind", 1)])
def test_no_label_lies_on_the_robot(name: str, seed: int, tmp_path: Path) -> None:
    """In the symbolic world the robot stands where it believes it does."""
    trace = Trace(recorded(name, seed))
    eye, robot = eye_of(trace), Robot(Rows(rr.RecordingStream("test")), pr2_model())
    convert(trace, tmp_path / "run.rrd", pr2_model())
    labels = labels_of(tmp_path / "run.rrd", eye)
    for step, belief in enumerate(trace.of(Belief)):
        limbs = np.array(robot.limbs(belief))
        shares = np.linspace(0.0, 1.0, 10)[:, None, None]
        places = ((1.0 - shares) * limbs[:, 0] + shares * limbs[:, 1]).reshape(-1, 3)
        columns, rows, _ = eye.pixels([(x, y, z) for x, y, z in places.tolist()]).T
        for text, (left, top, right, bottom) in labels[step].items():
            on = (columns > left) & (columns < right) & (rows > top) & (rows < bottom)
            assert not on.any(), (step, text)


def overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return bool(np.all([one[i] < other[i + 2] and other[i] < one[i + 2] for i in (0, 1)]))
