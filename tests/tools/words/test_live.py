"""What a person sees: the paper's belief table, the plan stack, the lines."""

import io

import pytest
from kit.places import ROOT
from rich.console import Console

from skolem.reasoner.agent import Turn
from skolem.reasoner.planning.goals import Closest
from skolem.tools.loop.setup import prepare
from skolem.tools.words.belief_table import belief_rows, size_of
from skolem.tools.words.live import Lines, Picture, drop_text, watcher_for, wording_for
from skolem.tools.words.plan_tree import plan_lines
from skolem.traces.messages import (
    Action,
    ActionResult,
    Belief,
    Decision,
    Denotation,
    Detection,
    HsvBelief,
    HsvVolume,
    LookAt,
    Meaning,
    ObjectBelief,
    Observation,
    Plan,
    PlanStep,
    RobotState,
    RunEnd,
    Wrench,
)
from skolem.traces.wording.things import Things
from skolem.traces.wording.wording import AS_RECORDED, InWords

NOBODY = Denotation(step=4, probability={})
ROBOT = RobotState(right_arm=(0.0,) * 7, left_arm=(0.0,) * 7)
MEANINGS: dict[str, Meaning] = {
    "green": HsvVolume(hue=(0.25, 0.45), saturation=(0.4, 1.0), value=(0.2, 1.0)),
    "red": HsvVolume(hue=(0.95, 0.05), saturation=(0.4, 1.0), value=(0.2, 1.0)),
}

WORDS = InWords(Things("exists o. B(Den(lambda x. Green(x), o), 0.9)"))


def known(**changes: object) -> ObjectBelief:
    before = ObjectBelief(
        exists=1.0,
        type={"can": 0.8, "box": 0.2},
        world_T_object=(2.0, 2.0, 0.7, 0.0),
        covariance=(0.0025, 0.0, 0.0, 0.0001, 0.0, 1.0),
        colour=HsvBelief(mean=(0.33, 0.9, 0.8), variance=(0.001, 0.01, 0.01)),
        log_weight=(-1.2, 0.36),
    )
    return before.model_copy(update=changes)


def belief(**objects: ObjectBelief) -> Belief:
    return Belief(
        step=4,
        version=9,
        world_T_base=(0.0, 0.0, 0.0),
        base_covariance=(0.0,) * 6,
        robot=ROBOT,
        anchors=tuple(objects),
        objects=objects,
        keys=(),
        joint_covariance=(),
    )


PLAN = Plan(
    step=4,
    cause="preimage_lost",
    false_fluents=("b(den(e1,sodaE),105361)",),
    layers=tuple(
        tuple(PlanStep(op=op, level=0, concrete=1, primitive=True, cost=0, subgoal=(), preimage=()) for op in layer)
        for layer in (("ExamineObj(e1, _o2_)", "Place(_o2_, desk)"), ("LookAt(_o2_)",))
    ),
    current=(0, 0),
)
DECISION = Decision(
    step=4, belief_version=9, subgoal=(), candidates=(), plan=("LookAt(_o2_)",), cost=105_361, expansions=3,
    clingo_calls=2, ground_atoms=9,
)  # fmt: skip
LOOK = Action(step=4, op="LookAt(_o2_)", args=("_o2_",), command=LookAt(pan=0.0, tilt=0.5))
DONE = ActionResult(step=4, status="done", robot=ROBOT)
SEEN = Detection(
    base_T_object=(1.0, 0.0, 0.7, 0.0), covariance=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0), type_log_likelihood={"can": 0.0},
    rgb=(0.0, 1.0, 0.0), points=99,
)  # fmt: skip


def test_rows_are_those_of_the_paper() -> None:
    shown = belief(
        _o2_=known(),
        _o3_=known(colour_seen=True, weighed=True),
        held=known(in_hand="right", colour_seen=True, colour=HsvBelief(mean=(0.99, 0.9, 0.8), variance=(0.01, 0, 0))),
    )
    assert belief_rows(shown, MEANINGS) == [
        ("_o2_", "can, .80", "(2.00, 2.00), med", "prior", "prior"),
        ("_o3_", "can, .80", "(2.00, 2.00), med", "green, low", "301 g, high"),
        ("held", "can, .80", "in hand", "red, med", "prior"),
    ]


@pytest.mark.parametrize(("share", "text"), [(1.0, "can, 1.00"), (0.5, "can, .50"), (0.004, "can, .00")])
def test_probabilities_have_no_leading_zero(share: float, text: str) -> None:
    assert belief_rows(belief(a=known(type={"can": share})), MEANINGS)[0][1] == text


def test_a_colour_without_a_word_is_shown_as_numbers() -> None:
    blue = known(colour_seen=True, colour=HsvBelief(mean=(0.6, 0.9, 0.8), variance=(0.001, 0.01, 0.01)))
    assert belief_rows(belief(a=blue), MEANINGS)[0][3] == "hsv 216 90% 80%, low"


def test_low_is_well_known() -> None:
    assert [size_of(sd, (0.1, 0.2)) for sd in (0.05, 0.1, 0.2, 0.3)] == ["low", "med", "med", "high"]


def test_the_stack_has_a_line_per_layer_with_the_chosen_step_marked() -> None:
    assert plan_lines(PLAN, AS_RECORDED) == ["<ExamineObj(e1, _o2_)>  Place(_o2_, desk)", "  <LookAt(_o2_)>"]
    said = ["<find out whether _o2_ is the green thing>; place _o2_ on desk", "  <look at _o2_>"]
    assert plan_lines(PLAN, WORDS) == said


def test_dropped_plans_say_which_fluents_became_false() -> None:
    assert drop_text([PLAN], WORDS) == "P(sodaE is the green thing) >= .9 is no longer believed"
    assert drop_text([PLAN], AS_RECORDED) == "preimage_lost: b(den(e1,sodaE),105361)"
    assert drop_text([PLAN.model_copy(update={"cause": "fell_back"})], WORDS) == ""


def test_a_line_per_executed_action_goes_to_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    with Lines(WORDS) as lines:
        lines.believed(belief(), 0)
        lines.decided(Turn(Closest(), NOBODY, plans=[PLAN], action=LOOK))
        lines.acted(LOOK, DONE, Observation(step=4, kind="look", detections=(SEEN,)))
        lines.decided(Turn(Closest(), NOBODY, action=LOOK))
        lines.acted(LOOK, DONE, Observation(step=4, kind="look"))
        wrench = Wrench(hand="right", force_newton=(0.1, 0.0, -3.4), samples=48)
        lines.acted(LOOK, DONE, Observation(step=4, kind="weigh", wrench=wrench))
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines() == [
        "step  4  look at _o2_ -> done, 1 detection  "
        "[new plan: P(sodaE is the green thing) >= .9 is no longer believed]",
        "step  4  look at _o2_ -> done, no detections",
        "step  4  look at _o2_ -> done, 3.40 N",
    ]


def console(width: int, height: int) -> Console:
    return Console(file=io.StringIO(), force_terminal=True, width=width, height=height, color_system="truecolor")


def shown(picture: Picture, width: int, height: int) -> str:
    """Return what a terminal of that size shows."""
    plain = Console(file=io.StringIO(), width=width, height=height, record=True)
    plain.print(picture.picture())
    return plain.export_text()


def test_the_picture_on_a_terminal_shows_belief_plans_and_progress() -> None:
    setup = prepare(ROOT / "scenarios" / "sim1_green.yaml", world="symbolic")
    screen = console(120, 40)
    with Picture(setup, screen, wording_for(setup, raw=False)) as picture:
        picture.believed(belief(_o2_=known(colour_seen=True), _o3_=known(exists=0.1)), 480)
        picture.decided(Turn(Closest(), NOBODY, plans=[PLAN], decisions=[DECISION], action=LOOK))
        picture.acted(LOOK, DONE, Observation(step=4, kind="look", detections=(SEEN,)))
        text = shown(picture, 120, 40)
        end = RunEnd(status="goal_achieved", steps=5, reason="every conjunct is believed", goal_probability=0.98)
        picture.decided(Turn(Closest(), NOBODY, end=end))
    for expected in (
        "goal  exists o.",
        "weight d",
        "_o2_",
        "■ green, low",
        "find out whether _o2_ is the green thing; place _o2_ on desk",
        "new plan: P(sodaE is the green thing) >= .9 is no longer believed",
        "step 4 of at most 60",
        "look at _o2_ -> done, 1 detection",
        "plan p = 0.900",
        "2.0 s simulated",
    ):
        assert expected in text
    assert isinstance(screen.file, io.StringIO)
    assert "goal believed achieved: every conjunct is believed" in screen.file.getvalue()


@pytest.mark.parametrize("number", [6, 40])
@pytest.mark.parametrize("hue", [0.33, 0.6])
def test_the_picture_fits_a_terminal_of_80_by_24_with_the_weights_in_view(number: int, hue: float) -> None:
    setup = prepare(ROOT / "scenarios" / "sim1_green.yaml", world="symbolic")
    colour = HsvBelief(mean=(hue, 0.9, 0.8), variance=(0.001, 0.01, 0.01))
    objects = {
        f"_o{i}_": known(type={"bottle": 1.0}, colour=colour, colour_seen=True, weighed=True) for i in range(number)
    }
    layers = (*PLAN.layers, *(PLAN.layers[0],) * 3)
    deep = PLAN.model_copy(update={"layers": layers, "current": (0,) * len(layers)})
    with Picture(setup, console(80, 24), wording_for(setup, raw=False)) as picture:
        picture.believed(belief(**objects), 480)
        picture.decided(Turn(Closest(), NOBODY, plans=[deep], decisions=[DECISION], action=LOOK))
        drawn = shown(picture, 80, 24).rstrip("\n").splitlines()
    assert len(drawn) < 24
    assert max(map(len, drawn)) <= 80
    assert any("weight d" in line for line in drawn)
    [row] = [line for line in drawn if line.split()[:1] == ["_o2_"]]
    assert row.rstrip().endswith("301 g, high")
    hidden = [line for line in drawn if line.strip().endswith("more)")]
    assert len(hidden) == (number > 6)
    assert "plan p = 0.900" in drawn[-1]


def test_without_a_terminal_there_are_lines_and_quiet_is_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    setup = prepare(ROOT / "scenarios" / "sim1_green.yaml", world="symbolic")
    assert type(watcher_for(setup, quiet=False)) is Lines
    with watcher_for(setup, quiet=True) as silence:
        silence.acted(LOOK, DONE, Observation(step=4, kind="look"))
    assert capsys.readouterr() == ("", "")
