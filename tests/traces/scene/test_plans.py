"""The drawn plan stack: which step is marked, what hangs on what, and that nothing overlaps."""

from itertools import combinations

import rerun as rr
from rerun.chunk import RrdReader

from skolem.traces.messages import Plan, PlanStep
from skolem.traces.scene.plans import Plans, in_lines, positions, tree
from skolem.traces.scene.rows import Rows, When
from skolem.traces.wording.things import Things
from skolem.traces.wording.wording import AS_RECORDED, InWords

WORDS = InWords(Things("exists o. B(Den(lambda x. Can(x), o), 0.9)", frozenset({"can"})))


def step(op: str, primitive: bool = True) -> PlanStep:
    return PlanStep(op=op, level=0, concrete=3, primitive=primitive, cost=0, subgoal=(), preimage=())


TOP = (step("ExamineObj(e1, o2)", primitive=False), step("Place(o2, desk)"))
BELOW = (step("LookAt(o2)"), step("Weigh(o2)"), step("Split((can,heavy), o2, 70240)", primitive=False))


def test_a_layer_hangs_on_the_marked_step_of_the_layer_above() -> None:
    rows = tree("goal", (TOP, BELOW), (0, 1), WORDS)
    assert [[node.id for node in row] for row in rows] == [["goal"], ["0.0", "0.1"], ["1.0", "1.1", "1.2"]]
    assert {node.parent for node in rows[1]} == {"goal"}
    assert {node.parent for node in rows[2]} == {"0.0"}


def test_only_the_step_that_is_carried_out_next_has_its_colour() -> None:
    rows = tree("goal", (TOP, BELOW), (0, 1), WORDS)
    nodes = [node for row in rows for node in row]
    following = next(node for node in nodes if node.id == "1.1")
    assert [node.id for node in nodes if node.colour == following.colour] == ["1.1"]


def test_nodes_of_a_row_do_not_overlap() -> None:
    rows = tree("exists o. B(Den(lambda x. Can(x), o), 0.9)", (TOP, BELOW, BELOW), (0, 1, 0), WORDS)
    nodes = [node for row in rows for node in row]
    boxes = list(zip(nodes, positions(rows), strict=True))
    for (one, (x, y)), (other, (u, v)) in combinations(boxes, 2):
        assert y != v or abs(x - u) > (one.width + other.width) / 2.0


def test_a_box_has_short_lines_broken_between_words() -> None:
    assert in_lines("drive to pick sodaC with the left hand") == "drive to pick sodaC with\nthe left hand"
    assert in_lines("Move(pick(left,sodaCwithALongName))") == "Move(pick(left,sodaCwithALongName))"


def test_boxes_say_steps_in_words_or_as_they_are_recorded() -> None:
    assert [node.label for node in tree("goal", (TOP,), (0,), WORDS)[1]] == [
        "find out whether o2 is\nthe can",
        "place o2 on desk",
    ]
    assert [node.label for node in tree("goal", (TOP,), (0,), AS_RECORDED)[1]] == [
        "ExamineObj(e1, o2)",
        "Place(o2, desk)",
    ]


def test_a_dropped_plan_is_shown_with_its_reason_until_the_next_step() -> None:
    stream = rr.RecordingStream("skolem")
    memory = stream.memory_recording()
    rows = Rows(stream)
    plans = Plans(rows, "goal", WORDS)
    plans.changed(Plan(step=0, cause="start", layers=(TOP, BELOW), current=(0, 1)), When(0, 0))
    lost = Plan(step=1, cause="preimage_lost", false_fluents=("b(den(e1,o2),105361)",), layers=(), current=())
    plans.changed(lost, When(240, 1))
    plans.step_begins(When(480, 2))
    rows.flush()
    assert memory is not None
    top, below = ([in_lines(WORDS.operation(step.op)) for step in layer] for layer in (TOP, BELOW))
    assert labels(memory.drain_as_bytes()) == [
        ["goal", *top, *below],
        ["goal", "dropped:\nP(o2 is the can) >= .9 is no longer\nbelieved", *top, "and what\nrefined it (1)"],
        ["goal"],
    ]


def labels(recording: bytes) -> list[list[str]]:
    """Return the labels of the nodes, row by row."""
    import tempfile
    from pathlib import Path

    with tempfile.NamedTemporaryFile(suffix=".rrd") as file:
        file.write(recording)
        file.flush()
        for chunk in RrdReader(Path(file.name)).stream().to_chunks():
            if chunk.entity_path == "/plan":
                found: list[list[str]] = chunk.to_record_batch().column("GraphNodes:labels").to_pylist()
                return found
    return []
