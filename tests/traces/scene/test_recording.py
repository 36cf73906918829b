"""A trace becomes a rerun recording: every message is drawn, on both timelines, and the same each time."""

import subprocess
from pathlib import Path

import pytest
from kit.recordings import recorded
from kit.views import filmed, rows_of
from rerun.chunk import RrdReader

from skolem.tools.view.viewer import binary
from skolem.tools.view.viewing import pr2_model
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, Belief, Decision, Denotation, Plan, TrueState
from skolem.traces.scene.recording import convert


@pytest.fixture(scope="module")
def trace() -> Trace:
    return Trace(recorded("sim3_unknown"))


@pytest.fixture(scope="module")
def recording(trace: Trace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("recording") / f"{trace.path.stem}.rrd"
    convert(trace, out, pr2_model())
    return out


def test_every_decision_has_a_row_of_what_it_was_taken_on(trace: Trace, recording: Path) -> None:
    rows, beliefs = rows_of(recording), list(trace.of(Belief))
    anchor = beliefs[0].anchors[0]
    for entity in ("belief/base", f"belief/{anchor}/place", f"belief/{anchor}/label"):
        assert rows[entity] - 1 == len(beliefs), entity  # one row for all times: its frame
    for quantity in ("place", "type", "colour", "weight"):
        assert rows[f"plots/entropy/{quantity}"] - 1 == len(beliefs)
    for region in beliefs[0].regions:
        assert rows[f"regions/{region}/unseen"] - 1 == rows[f"regions/{region}/label"] - 1 == len(beliefs)
        assert rows[f"plots/seen/{region}"] - 1 == len(beliefs)


def test_every_plan_is_drawn_and_every_decision_and_action_told(trace: Trace, recording: Path) -> None:
    rows = rows_of(recording)
    assert rows["plan"] >= len(list(trace.of(Plan)))
    assert rows["log"] >= len(list(trace.of(Decision))) + len(list(trace.of(Action)))


def test_whoever_was_once_thought_to_be_meant_has_a_curve(trace: Trace, recording: Path) -> None:
    rows = rows_of(recording)
    tables = [told.probability["e1"] for told in trace.of(Denotation)]
    likely = {anchor for table in tables for anchor, p in table.items() if p > 0.01}
    assert likely
    assert {f"plots/den/e1/{anchor}" for anchor in likely} <= set(rows)


def test_without_recorded_joints_the_robot_moves_as_it_believes(trace: Trace, recording: Path) -> None:
    rows, count = rows_of(recording), len(list(trace.of(Belief)))
    for name in ("base_x", "torso_lift_joint", "head_pan_joint", "r_elbow_flex_joint", "l_wrist_roll_joint"):
        assert rows[f"robot/joints/{name}"] == count
    assert any("visual_geometries" in entity for entity in rows)


def test_every_true_object_is_drawn_apart_from_the_believed_ones(trace: Trace, recording: Path) -> None:
    rows = rows_of(recording)
    for thing in next(trace.of(TrueState)).objects:
        assert any(entity.startswith(f"truth/{thing.id}/") for entity in rows)


def test_rows_stand_on_both_timelines(recording: Path) -> None:
    chunks = [c for c in RrdReader(recording).stream().to_chunks() if c.entity_path == "/plan"]
    assert chunks
    assert all({"step", "sim_time"} <= set(chunk.timeline_names) for chunk in chunks)


def test_two_conversions_compare_equal(trace: Trace, recording: Path, tmp_path: Path) -> None:
    again = tmp_path / recording.name
    convert(trace, again, pr2_model())
    compared = subprocess.run(
        [binary(), "rrd", "compare", "--unordered", recording, again], capture_output=True, text=True, check=False
    )
    assert compared.returncode == 0, compared.stdout + compared.stderr


@pytest.mark.physics
def test_recorded_joints_things_in_motion_and_pictures_are_all_there(tmp_path: Path) -> None:
    trace = filmed(tmp_path / "sim1.mcap", "sim1_green", 2)
    out = tmp_path / "sim1.rrd"
    convert(trace, out, pr2_model())
    rows = rows_of(out)
    joints = len(list(trace.messages("/robot/joint_states")))
    assert joints > 0
    assert {rows[f"robot/joints/{name}"] for name in ("base_x", "l_elbow_flex_joint", "r_gripper_l_finger_joint")} == {
        joints
    }
    looks = len(list(trace.messages("/camera/rgb")))
    assert looks == 2
    assert rows["camera/picture"] == rows["camera/depth"] == rows["camera/picture/detections"] == looks
    assert rows["camera/picture/labels"] == looks
