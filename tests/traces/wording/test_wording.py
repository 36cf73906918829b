"""Recorded terms in words: nothing internal is left of what skolem records, and what other rules bring stays whole."""

import re
from pathlib import Path

import pytest
from hypothesis import given, strategies as st
from kit.descriptions import wide_goals
from kit.places import GOLDEN, ROOT

from skolem.reasoner.language.expressions import Goal
from skolem.reasoner.lint.fluent_kinds import ACTIVITIES, FLUENTS, shape
from skolem.reasoner.terms import Compound, nll, parse_term
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, Decision, HsvVolume, Plan, RunEnd
from skolem.traces.wording.amounts import probability
from skolem.traces.wording.descriptions import descriptions
from skolem.traces.wording.fluents import known
from skolem.traces.wording.of_run import wording_of
from skolem.traces.wording.recorded import read, within
from skolem.traces.wording.sentences import sentences
from skolem.traces.wording.things import Things
from skolem.traces.wording.wording import AS_RECORDED, InWords

GOAL = "exists o. B(Den(lambda x. Green(x), o), 0.9) & B(In(o, table1), 0.9)"
GREEN = HsvVolume(hue=(0.25, 0.45), saturation=(0.4, 1.0), value=(0.2, 1.0))
WORDS = InWords(Things(GOAL, frozenset({"soda", "can"}), {"green": GREEN}))
# a term, a constant of the rules, micro-nats
INTERNAL = re.compile(r"(?<!\w)(?!P\()\w*\(|\b(?:sk|var|any|e\d+)\b|(?<!\.)\b\d{4,}|\w_\w")
QUOTED = re.compile(r'"[^"]*"')  # the goal's own text
RULES = sorted((ROOT / "rules").glob("*.lp"))
TRACES = sorted(GOLDEN.glob("*.mcap"))


def recorded(trace: Trace) -> tuple[set[str], set[str]]:
    """Return every fluent and every operation that a run records."""
    fluents, operations = set[str](), set[str]()
    for found in trace.messages("/plan", "/decision", "/action"):
        match found.message:
            case Plan(layers=layers, false_fluents=false, cause=cause):
                steps = [step for layer in layers for step in layer]
                operations |= {step.op for step in steps}
                fluents |= {fluent for step in steps for fluent in (*step.subgoal, *step.preimage)}
                (operations if cause == "refused" else fluents).update(false[: 1 if cause == "refused" else None])
                fluents |= set(false[1:])
            case Decision(subgoal=subgoal, plan=plan, candidates=candidates):
                fluents |= set(subgoal)
                operations |= {*plan, *(candidate.op for candidate in candidates)}
            case Action(op=op):
                operations.add(op)
    return fluents, operations


@pytest.mark.parametrize("path", TRACES, ids=lambda path: path.stem)
def test_every_recorded_fluent_and_operation_of_the_golden_runs_gets_words(path: Path) -> None:
    trace = Trace(path)
    words = wording_of(trace)
    fluents, operations = recorded(trace)
    assert fluents
    assert operations
    for said in (*map(words.fluent, fluents), *map(words.operation, operations)):
        assert not INTERNAL.search(QUOTED.sub("", said)), said


@pytest.mark.parametrize("pattern", FLUENTS)
def test_every_fluent_that_the_robot_can_answer_gets_words(pattern: str) -> None:
    said = {
        "any,any,any,any": "any,sd(8),any,223144" if "weight" in pattern else "any,sd(8,8,150),any,223144",
        "any": "105361",
        "properties": "(green,heavy)",
        "activity": "pick(left,object)",
        "expression": "e1",
    }
    facts = pattern.replace("together(any,any)", "together(den(e1,object),on(object,object))")
    text = re.sub("|".join(said), lambda found: said[found[0]], facts)
    assert not INTERNAL.search(WORDS.fluent(text)), WORDS.fluent(text)


def test_the_rules_use_no_other_fluents_and_no_operator_without_words() -> None:
    kinds = {shape(parse_term(pattern)) for pattern in FLUENTS}
    operators = set[str]()
    for path in RULES:
        heads = re.findall(r"^(result|precond|operation)\(\w+, (\w+)\((\w+)?", path.read_text(), re.MULTILINE)
        for head, name, inner in heads:
            if head == "operation":
                operators.add(name)
            else:
                assert (f"{name}({inner})" if name in ("b", "bn") and inner.islower() else name) in kinds | {"b"}
    assert operators >= {
        "examine_obj",
        "find_obj",
        "infer",
        "look_at",
        "look_at_region",
        "pick",
        "place",
        "remove_obst",
    }
    arguments = {
        "find_obj": "(e1,_reg1_,sk(var(o)))",
        "examine_obj": "(e1,o)",
        "infer": "(green,o)",
        "place": "(o,s)",
        "count_objs": "(s1)",
        "witness_obj": "(e1,o,p)",
        "see_both": "(o,p)",
        "compare": "(o,p)",
        "unfit": "(e1,o)",
        "the_obj": "(e1,o)",
        "refute_obj": "(e1_any,o)",
        "rule_out": "(e1_any,_reg1_)",
        "believe_together": "(den(e1,o),on(o,s))",
    }
    steps = [f"{name}{arguments.get(name, '(o)')}" for name in operators - {"remove_obst"}]
    for step in (*steps, "remove_obst(pick(left,o))", "split((green,),o,1)", "move(look(o))", "weigh(o)"):
        assert not INTERNAL.search(WORDS.operation(step)), step
    for activity in ACTIVITIES:
        assert not INTERNAL.search(WORDS.operation(activity.replace("any", "nothing"))), activity


@pytest.mark.parametrize(
    ("term", "said"),
    [
        ("b(den(e1,sodaE),105361)", "P(sodaE is the green thing) >= .9"),
        ("b(den(e2,sodaE),105361)", "P(sodaE is meant) >= .9"),
        ("b(den(e1,sk(var(o))),105361)", "P(the object to be found is the green thing) >= .9"),
        ("b(on(sk(var(o)),table1),105361)", "P(the green thing to be found is on table1) >= .9"),
        ("b(holds((can,green),o1),105361)", "P(o1 is a green can) >= .9"),
        ("b(holds((heavy,green),o1),105361)", "P(o1 is heavy and green) >= .9"),
        ("b(heavier_than(o1,number(400000)),105361)", "P(o1 is heavier than 400) >= .9"),
        ("b(polished(o1),105361)", "P(polished(o1)) >= .9"),
        ("bn(pose(o1),any,sd(8,8,150),any,223144)", "P(pose of o1 is known within 8 mm and 9 degrees) >= .8"),
        (
            "bn(pose(o1),v(1200,100,1571),sd(20,30,any),tol(50,50,50),223144)",
            "P(pose of o1 is known within 20 mm in x and 30 mm in y, near x 1.20 m, y 0.10 m, 90 degrees) >= .8",
        ),
        (
            "bn(colour(o1),v(350,768,638),sd(24,64,36),tol(49,232,361),693147)",
            "P(colour of o1 is known to be about green) >= .5",
        ),
        (
            "bn(colour(o1),v(50,768,638),sd(24,64,36),tol(49,232,361),693147)",
            "P(colour of o1 is known to be about hue 18 degrees, saturation 77 %, value 64 %) >= .5",
        ),
        (
            "bn(weight(o1),v(994),sd(134),tol(1689),693147)",
            "P(weight of o1 is known within 13 %, between 499 g and 14.6 kg) >= .5",
        ),
        ("krd(sk(var(o)))", "the green thing to be found has been found"),
        ("clean(o1)", "clean(o1)"),
        ("not a term(", "not a term("),
    ],
)
def test_a_fluent_reads_as_a_clause(term: str, said: str) -> None:
    assert WORDS.fluent(term) == said
    assert AS_RECORDED.fluent(term) == term


@pytest.mark.parametrize(
    ("recorded", "said"),
    [
        ("Move(pick(left,sodaC))", "drive to pick sodaC with the left hand"),
        ("Place(sodaC, table1)", "place sodaC on table1"),
        (
            "put(right,o1,table1,pick(left,o2))",
            "place o1 on table1, out of the way of picking o2 with the left hand, with the right hand",
        ),
        ("ExamineObj(e1, sodaE)", "find out whether sodaE is the green thing"),
        ("FindObj(e1, _reg1_, sk(var(o)))", "find the green thing in region _reg1_"),
        ("RemoveObst(pick(left,can))", "clear the way to pick can with the left hand"),
        ("Split((can,heavy), o1, 70240)", "sum up that o1 is a heavy can"),
        ("Beckon(sodaC, table1)", "Beckon(sodaC, table1)"),
        ("Wait", "Wait"),
    ],
)
def test_an_operation_reads_as_what_is_to_be_done(recorded: str, said: str) -> None:
    assert WORDS.operation(recorded) == said
    assert AS_RECORDED.operation(recorded) == recorded


@pytest.mark.parametrize(
    ("goal", "said"),
    [
        ("B(Den(lambda x. Soda(x) & Green(x), o), 0.9)", ["the green soda"]),
        ("B(Den(lambda x. And(Heavy(x), Soda(x)), o), 0.9)", ["the heavy soda"]),
        ("B(Den(lambda x. Green(x) | Can(x), o), 0.9)", ["the thing that is green or a can"]),
        ("B(Den(lambda x. Can(x) & Soda(x), o), 0.9)", ["the thing that is a can and a soda"]),
        ("B(Den(the x. Soda(x) & Green(x), o), 0.9)", ["the green soda"]),
        ("B(Den(heaviest x. Soda(x) & Green(x), o), 0.9)", ["the heaviest green soda"]),
        ("B(Den(lightest x. Green(x) | Red(x), o), 0.9)", ["the lightest thing that is green or red"]),
        ("B(Den(λx. Soda(x) ∧ Green(x), o), 0.9) & B(Den(lambda x. Soda(x) & Green(x), p), 0.9)", ["the green soda"]),
        ("B(Den(lambda x. Red(x), o), .9) & B(Den(iota x. Red(x), p), .9)", ["the red thing", "the red thing"]),
        ("B(Den(lambda x. not Green(x), o), 0.9)", ['what "lambda x. not Green(x)" describes']),
        ("B(Den(nearest x to can. Soda(x), o), 0.9)", ['what "nearest x to can. Soda(x)" describes']),
        ("B(Den(lambda x. On(x, table1), o), 0.9)", ['what "lambda x. On(x, table1)" describes']),
        ("B(Den(lambda x. Red(x), o), .9) & B(Den(lambda x. Can(x), p), .9)", ["the red thing", "the can"]),
    ],
)
def test_a_description_reads_as_the_goal_says_it(goal: str, said: list[str]) -> None:
    words = InWords(Things(goal, frozenset({"soda", "can"})))
    assert [words.described(f"e{i + 1}") for i in range(len(said))] == said
    assert words.described(f"e{len(said) + 1}") == "what is meant"


@given(wide_goals())
def test_descriptions_are_numbered_as_the_reasoner_numbers_them(goal: Goal) -> None:
    found, _ = descriptions(str(goal))
    assert {constant: description.text for constant, description in found.items()} == {
        constant: str(expression) for constant, expression in goal.expressions.items()
    }


@given(wide_goals())
def test_sentences_are_numbered_and_worded_as_the_goal_says_them(goal: Goal) -> None:
    assert sentences(str(goal)) == {name: str(sentence) for name, sentence in goal.sentences.items()}


COUNTING = (
    "exists o. B(exactly 2 x. Can(x)\n  & On(x, table1), 0.9) & B(Den(the x. Green(x) & Can(x), o), 0.9)"
    " & B(exactly 2 x. Can(x) & On(x,table1), 0.8) & B(¬Red(o1), 0.9) & B(And(Red(o1), Can(o1)), 0.9)"
)
TWO = '"exactly 2 x. Can(x) & On(x, table1)"'


@pytest.mark.parametrize(
    ("term", "said"),
    [
        ("b(holds_of_the_world(s1),105361)", f"P({TWO} is true) >= .9"),
        ("b(holds_of_the_world(s2),105361)", 'P("¬Red(o1)" is true) >= .9'),
        ("b(holds_of_the_world(s3),105361)", "P(what the goal says of the world is true) >= .9"),
        ("b(den(e1_any,o1),105361)", "P(o1 fits the description of the green can) >= .9"),
        ("b(unlike(e1_any,o1),105361)", "P(o1 does not fit the description of the green can) >= .9"),
        ("b(unlike(e1,o1),105361)", "P(o1 is not the green can) >= .9"),
        ("b(unlike(e9,o1),105361)", "P(o1 is not meant) >= .9"),
        ("b(den(s1_any,o1),105361)", f"P(o1 fits what {TWO} counts) >= .9"),
        ("b(den(s1_kind,sk(one_of(s1,0))),105361)", f"P(the object to be found fits what {TWO} is about) >= .9"),
        (
            "b(none_in(e1_any,_reg1_),105361)",
            "P(region _reg1_ hides nothing that fits the description of the green can) >= .9",
        ),
        ("b(none_in(e9,_reg1_),105361)", "P(region _reg1_ hides nothing that is meant) >= .9"),
        ("differ(sk(one_of(s1,0)),sk(one_of(s1,1)))", "object 1 to be found and object 2 to be found are two objects"),
        ("b(together(den(e1,o1),on(o1,t)),105361)", "P(o1 is the green can and o1 is on t) >= .9"),
        ("CountObjs(s1)", f"find out whether {TWO} is true"),
        ("TheObj(e1, o1)", "conclude that o1 is the green can, and no other"),
        ("RefuteObj(e1_any, o1)", "make sure that o1 does not fit the description of the green can"),
        ("refute(e1_any,(not__green,),o1,9)", "make sure that o1 does not fit the description of the green can"),
        ("put_away(s1_any,o1,table1,9)", f"make sure that o1 does not fit what {TWO} counts"),
        ("RuleOut(s1_any, r)", f"make sure that region r hides nothing that fits what {TWO} counts"),
        ("BelieveTogether(den(e1,o1), on(o1,t))", "conclude that o1 is the green can and o1 is on t, both at once"),
    ],
)
def test_what_is_counted_and_refuted_reads_as_the_goal_says_it(term: str, said: str) -> None:
    words = InWords(Things(COUNTING, frozenset({"can"})))
    found = read(term)
    assert found is not None
    assert (words.fluent(term) if known(found) else words.operation(term)) == said
    refused = Plan(step=3, cause="refused", false_fluents=("refute_obj(e1_any,o1)",), layers=())
    assert words.drop(refused) == "cannot be done here: make sure that o1 does not fit the description of the green can"


@given(st.floats(1e-6, 1 - 1e-6))
def test_a_bound_is_right_to_two_digits_of_itself_and_of_what_is_left(p: float) -> None:
    said = float(probability(nll(p)))
    assert abs(said - p) <= 0.051 * min(p, 1.0 - p) + 1e-6


@given(st.recursive(st.sampled_from(["a", "o1", "-7"]), lambda inner: st.lists(inner, min_size=1).map(tuple)))
def test_a_term_is_read_back_from_its_text(values: object) -> None:
    def term(value: object) -> str:
        return f"f({','.join(map(term, value))})" if isinstance(value, tuple) else str(value)

    text = term(values)
    found = read(text)
    if text.count("(") <= 100:
        assert found is not None
        assert str(found).replace(" ", "") == text
        assert not isinstance(parse_term(text), Compound) or found.args


@pytest.mark.parametrize("text", ["", "f(", "f)", "f(a b)", "f(,)", "(" * 5000, "f(" * 5000 + ")" * 5000])
def test_what_is_no_term_is_not_read(text: str) -> None:
    assert read(text) is None


def test_terms_within_a_sentence_read_as_words_and_those_of_rules_stay() -> None:
    said = WORDS.sentence("found impossible: Weigh(sodaC), Place(o1, table1); nothing (yet) of B(o) or own(o1)")
    assert said == "found impossible: weigh sodaC, place o1 on table1; nothing (yet) of B(o) or own(o1)"
    spent = WORDS.sentence("budget of the motion planner spent: Move(pick(right,sodaC)) (tried 44 stances)")
    assert spent == "budget of the motion planner spent: drive to pick sodaC with the right hand (tried 44 stances)"
    rule = "a rule that executes weigh(O) must demand held(right, O)"
    assert WORDS.sentence(rule) == rule
    assert AS_RECORDED.sentence("Weigh(sodaC)") == "Weigh(sodaC)"
    assert list(within("f(a) g(h(b), c) k(")) == [(0, 4), (5, 15)]


def test_of_several_bounds_on_one_probability_the_least_is_told() -> None:
    lost = ("b(den(e1,sodaB),105361)", "b(den(e1,sodaB),2675270)")
    plan = Plan(step=3, cause="preimage_lost", false_fluents=lost, layers=())
    assert WORDS.drop(plan) == "P(sodaB is the green thing) >= .069 is no longer believed"
    other = plan.model_copy(update={"false_fluents": (lost[0], "b(exists(sodaB),105361)")})
    said = "P(sodaB is the green thing) >= .9 and P(sodaB exists) >= .9 are no longer believed"
    assert WORDS.drop(other) == said
    mixed = plan.model_copy(update={"false_fluents": (lost[0], "holding(sodaB)")})
    assert WORDS.drop(mixed) == "this is not so now: P(sodaB is the green thing) >= .9; a hand holds sodaB"
    placeholder = "b(den(e1,sk(var(o))),105361)"
    found = plan.model_copy(update={"false_fluents": (placeholder, "b(exists_in(e1,_reg1_),1423590)")})
    assert WORDS.drop(found) == "P(the green thing is hidden in region _reg1_) >= .24 is no longer believed"
    only = plan.model_copy(update={"false_fluents": (placeholder,)})
    assert WORDS.drop(only) == "P(the object to be found is the green thing) >= .9 is no longer believed"
    assert AS_RECORDED.drop(plan) == f"preimage_lost: {lost[0]}, {lost[1]}"


def test_a_step_that_cannot_be_done_is_told_with_what_it_lacks() -> None:
    refused = Plan(step=3, cause="refused", false_fluents=("weigh(sodaC)", "held(right,sodaC)"), layers=())
    assert WORDS.drop(refused) == "cannot be done here: weigh sodaC, which needs that the right hand holds sodaC"
    alone = refused.model_copy(update={"false_fluents": ("weigh(sodaC)",)})
    assert WORDS.drop(alone) == "cannot be done here: weigh sodaC"
    nothing = refused.model_copy(update={"cause": "preimage_lost", "false_fluents": ()})
    assert WORDS.drop(nothing) == "no step of the plan can be taken any more"


def test_codes_read_as_words_and_codes_of_own_rules_lose_their_underscores() -> None:
    assert WORDS.refusal("not_graspable") == "no hand can grasp it"
    assert WORDS.refusal("too_slippery") == "too slippery"
    assert WORDS.risk("missed(sodaB)", 0.9) == "goes well with p = 0.900; the risk: sodaB is not detected"
    again = "goes well with p = 0.900; the risk: sodaB is not detected in one of the looks that are needed too"
    assert WORDS.risk("missed_again(sodaB)", 0.9) == again
    assert WORDS.risk("slippery", 0.8) == "goes well with p = 0.800; the risk: slippery"
    assert AS_RECORDED.risk("slippery", 0.8) == "cost: slippery, p = 0.800"
    end = RunEnd(status="goal_achieved", steps=3, reason="every conjunct is believed", goal_probability=0.9)
    assert WORDS.end(end) == "goal believed achieved: every conjunct is believed"
    assert AS_RECORDED.end(end) == "goal_achieved: every conjunct is believed"
    assert WORDS.cause("refine") == "step planned in more detail"
