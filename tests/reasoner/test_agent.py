"""Whole turns of the reasoner with the real rules, on a belief that is a table."""

import re
from collections.abc import Collection

import numpy as np
import pytest
from kit.minds import Region, TableBelief, Thing
from kit.papers import GREEN_TO_TABLE1, example, three_sodas
from kit.places import DATA
from kit.plays import BLUE, GREEN, LIMITS, RED, Play
from numpy.typing import NDArray

from skolem.reasoner import agent
from skolem.reasoner.agent import Agent, Turn
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.planning.hierarchy import Change
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.regression import Step
from skolem.reasoner.rulebook.book import Rulebook
from skolem.traces.messages import Quantity

HEAVY_SODA = "exists o. B(Den(lambda x. And(Heavy(x), Soda(x)), o), 0.9) & B(In(o, table1), 0.9)"


@pytest.fixture(scope="module")
def rulebook() -> Rulebook:
    return Rulebook.load(Queries)


def test_the_candidates_are_examined_one_after_another_and_the_stack_is_popped_after_each_disappointment(
    rulebook: Rulebook,
) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    operators = play.run()
    assert operators == [
        "Move(look(sodaE))",
        "LookAt(sodaE)",
        "Move(look(sodaB))",
        "LookAt(sodaB)",
        "Move(look(sodaC))",
        "LookAt(sodaC)",
        "Move(pick(left,sodaC))",
        "LookAt(sodaC)",
        "Pick(sodaC)",
        "Move(place(sodaC,table1,nothing))",
        "LookAt(table1)",
        "Place(sodaC, table1)",
    ]
    end = play.turns[-1].end
    assert end is not None
    assert (end.status, end.anchor) == ("goal_achieved", "sodaC")
    lost = [
        (p.step, p.false_fluents) for t in play.turns for p in t.plans if p.cause == "preimage_lost" and not p.layers
    ]
    assert [step for step, _ in lost] == [2, 4]
    assert all(any("den(e1" in fluent for fluent in fluents) for _, fluents in lost)


def test_the_first_plan_supposes_the_likeliest_description_and_then_places(rulebook: Rulebook) -> None:
    things = three_sodas()
    things["sodaC"].hsv, things["sodaC"].hsv_sd = (GREEN, 0.8, 0.8), 0.2
    turn = next(iter(Play(rulebook, GREEN_TO_TABLE1, things).turns_to_the_end()))
    assert turn.decisions[0].plan == ("ExamineObj(e1, sodaC)", "Place(sodaC, table1)")


def test_a_heavy_object_is_found_by_weighing_and_is_not_picked_twice(rulebook: Rulebook) -> None:
    weights = {"sodaE": -1.9, "sodaB": -1.8, "sodaC": -0.5}
    play = Play(rulebook, HEAVY_SODA, three_sodas(), log_kg=weights)
    operators = play.run()
    assert operators[-1] == "Place(sodaC, table1)"
    assert [op for op in operators if op.startswith("Weigh")] == ["Weigh(sodaE)", "Weigh(sodaB)", "Weigh(sodaC)"]
    assert operators.count("Pick(sodaC)") == 1
    assert operators.index("Pick(sodaB)") > max(i for i, op in enumerate(operators) if op.startswith("Place(sodaE"))


def test_an_object_is_looked_at_before_it_is_picked_while_its_pose_is_poorly_known(rulebook: Rulebook) -> None:
    things = three_sodas()
    things["sodaC"].hsv, things["sodaC"].hsv_sd, things["sodaC"].pose_sd = (GREEN, 0.9, 0.8), 0.01, 0.1
    operators = Play(rulebook, GREEN_TO_TABLE1, things).run()
    assert operators.index("LookAt(sodaC)") < operators.index("Pick(sodaC)")


def test_no_geometry_is_asked_about_a_later_abstract_step_before_the_first_is_done(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    for turn in play.turns_to_the_end():
        if turn.action is not None and turn.action.op == "LookAt(sodaC)":
            break
    room = "blockers place"  # which takes no motion
    assert not [q for q in play.geometry.asked if "pick" in q or ("place" in q and not q.startswith(room))]


def test_without_a_plan_the_run_ends_with_the_reason_and_the_best_candidate(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": RED})
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert end.goal_probability < 0.1
    assert "no plan" in end.reason


def test_what_the_geometry_cannot_do_is_given_up_without_spinning(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    play.geometry.impossible = {"look(sodaC)", "pick(right, sodaC)", "pick(left, sodaC)"}
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert "Move(look(sodaC))" in end.reason


def test_an_action_that_changes_nothing_is_given_up_after_some_repeats(rulebook: Rulebook) -> None:
    limits = LIMITS.model_copy(update={"repeats": 4})
    hues = {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN}
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), hues, limits=limits)
    play.fails = {"Pick(sodaC)"}
    operators = play.run()
    assert operators.count("Pick(sodaC)") == 2 * limits.repeats  # with each hand
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert "Pick(sodaC)" in end.reason


def test_after_some_looks_in_vain_the_next_is_from_elsewhere(rulebook: Rulebook) -> None:
    limits = LIMITS.model_copy(update={"repeats": 5, "same_looks": 2})
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE}, limits=limits)
    play.fails = {"LookAt(sodaC)"}
    operators = play.run()
    first = operators.index("Move(look(sodaC))")
    look, move = "LookAt(sodaC)", "Move(look(sodaC))"
    assert operators[first:] == [move, look, look, move, look, look, move, look]
    assert play.geometry.asked.count("approach look(sodaC) from elsewhere") == 2
    end = play.turns[-1].end
    assert end is not None
    assert "without success 5 times: look(sodaC)" in end.reason


class DimCamera(Play):
    """A world in which one look at a colour does not suffice: each adds what the sensor promises, or nothing."""

    NOISE = 0.15

    def __init__(self, rulebook: Rulebook, useless: Collection[int] = ()) -> None:
        limits = LIMITS.model_copy(update={"repeats": 4, "same_looks": 2})
        tables = {f"table{k}": Thing({"table": 1.0}, pose_sd=0.005) for k in (1, 2)}
        can = Thing({"soda": 0.95, "bottle": 0.05}, on="table2")
        super().__init__(rulebook, GREEN_TO_TABLE1, tables | {"can": can}, limits=limits)
        self.belief.observation_covariance = self._noise  # type: ignore[method-assign]
        self._useless, self._looks = useless, 0

    def carry_out(self, turn: Turn) -> None:
        super().carry_out(turn)
        if turn.action is not None and turn.action.op == "LookAt(can)":
            self._looks += 1
            can = self.belief.things["can"]
            if self._looks not in self._useless:
                can.hsv, can.hsv_sd = (GREEN, 0.9, 0.8), (can.hsv_sd**-2 + self.NOISE**-2) ** -0.5

    def _noise(self, quantity: Quantity, anchor: str, at: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        if quantity == "colour":
            return np.eye(3) * self.NOISE**2
        return TableBelief.observation_covariance(self.belief, quantity, anchor, at)


def test_looks_that_bring_an_object_nearer_to_what_is_asked_are_not_in_vain(rulebook: Rulebook) -> None:
    play = DimCamera(rulebook)
    operators = play.run()
    *looks, _before_pick = [i for i, operator in enumerate(operators) if operator == "LookAt(can)"]
    assert len(looks) > 4
    assert looks == list(range(looks[0], looks[-1] + 1))
    assert play.turns[-1].end is not None
    assert play.turns[-1].end.status == "goal_achieved"


def test_looks_that_bring_nothing_are_in_vain_although_others_did(rulebook: Rulebook) -> None:
    play = DimCamera(rulebook, useless={3, 4})
    operators = play.run()
    first = operators.index("LookAt(can)")
    assert operators[first : first + 6] == ["LookAt(can)"] * 4 + ["Move(look(can))", "LookAt(can)"]


def test_where_nothing_known_can_be_meant_the_nearest_object_is_named(rulebook: Rulebook) -> None:
    play = Play(rulebook, HEAVY_SODA, three_sodas(), log_kg={"sodaE": -1.9, "sodaB": -1.8, "sodaC": -2.5})
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.anchor in ("sodaE", "sodaB", "sodaC")
    assert end.conjuncts["soda"] > 0.9 > 0.001 > end.conjuncts["heavy"]


def test_the_limit_of_steps_ends_the_run(rulebook: Rulebook) -> None:
    limits = LIMITS.model_copy(update={"steps": 3})
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED}, limits=limits)
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert (end.status, end.steps) == ("limit_reached", 3)


def test_plans_that_change_without_end_end_the_run(rulebook: Rulebook, monkeypatch: pytest.MonkeyPatch) -> None:
    def change_for_ever(agent: Agent, turn: Turn, step: int, _current: Step) -> None:
        turn.plans.append(agent._stack.message(step, Change("refine")))

    monkeypatch.setattr(Agent, "_refine", change_for_ever)
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas())
    assert play.run() == []
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "limit_reached"
    assert "limits.plan_changes" in end.reason


def test_a_goal_that_is_believed_already_needs_no_action(rulebook: Rulebook) -> None:
    things = three_sodas()
    things["sodaE"].hsv, things["sodaE"].hsv_sd = (GREEN, 0.9, 0.8), 0.01
    assert Play(rulebook, GREEN_TO_TABLE1, things).run() == []


def test_the_threshold_of_the_goal_decides_whether_anything_is_done(rulebook: Rulebook) -> None:
    things = three_sodas()
    things["sodaE"].hsv, things["sodaE"].hsv_sd = (GREEN, 0.9, 0.8), 0.1
    assert Play(rulebook, GREEN_TO_TABLE1.replace("x), o), 0.9", "x), o), 0.5"), things).run() == []
    assert Play(rulebook, GREEN_TO_TABLE1, things, {"sodaE": GREEN}).run() == ["Move(look(sodaE))", "LookAt(sodaE)"]


def test_the_same_object_must_satisfy_the_whole_goal(rulebook: Rulebook) -> None:
    """One object is green elsewhere, another stands on the table and is red: nothing is achieved yet."""
    things = three_sodas()
    things["sodaE"].hsv, things["sodaE"].hsv_sd = (RED, 0.9, 0.8), 0.01
    things["sodaC"].hsv, things["sodaC"].hsv_sd = (GREEN, 0.9, 0.8), 0.01
    assert Play(rulebook, GREEN_TO_TABLE1, things).run()[-1] == "Place(sodaC, table1)"


def test_the_cost_of_a_decision_is_counted_in_calls_and_expansions(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    play.run()
    for turn in play.turns:
        assert sum(d.clingo_calls for d in turn.decisions) <= 30
        assert sum(d.expansions for d in turn.decisions) <= 200


# ---------------------------------------------------------------- searching, clearing


def test_regions_are_searched_until_an_object_that_is_meant_turns_up(rulebook: Rulebook) -> None:
    """The paper's third simulation: tables known, no object known."""
    things = {a: t for a, t in three_sodas().items() if a.startswith("table")}
    regions = {f"_reg{k}_": Region(f"table{k}", objects=1.0) for k in (1, 2, 3)}
    new = {
        "_reg1_": {"_o1_": Thing({"soda": 0.9, "bottle": 0.1}, on="table1", hsv=(RED, 0.9, 0.8), hsv_sd=0.01)},
        "_reg2_": {"_o2_": Thing({"soda": 0.9, "bottle": 0.1}, on="table2", hsv=(GREEN, 0.9, 0.8), hsv_sd=0.01)},
    }
    play = Play(rulebook, GREEN_TO_TABLE1, things, regions=regions, found=new)
    operators = play.run()
    assert [op for op in operators if op.startswith("LookAtRegion")] == ["LookAtRegion(_reg1_)", "LookAtRegion(_reg2_)"]
    assert operators[-1] == "Place(_o2_, table1)"
    assert play.turns[0].decisions[0].plan == ("FindObj(e1, _reg1_, sk(var(o)))", "Place(sk(var(o)), table1)")


def test_the_likelier_region_is_searched_first(rulebook: Rulebook) -> None:
    things = {a: t for a, t in three_sodas().items() if a.startswith("table")}
    regions = {"_reg1_": Region("table1", objects=0.1), "_reg2_": Region("table2", objects=0.3)}
    play = Play(rulebook, GREEN_TO_TABLE1, things, regions=regions)
    assert [op for op in play.run() if op.startswith("LookAtRegion")] == [
        "LookAtRegion(_reg2_)",
        "LookAtRegion(_reg1_)",
    ]
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert end.regions == {"_reg1_": 0.95, "_reg2_": 0.95}


def test_the_illustrative_example_runs_as_the_paper_tells_it(rulebook: Rulebook) -> None:
    play = example()
    operators = play.run()
    first = play.turns[0].decisions[0].plan
    assert first == ("ExamineObj(e1, o2)", "Place(o2, desk)")
    place_o1 = next(i for i, op in enumerate(operators) if op.startswith("Place(o1"))
    assert place_o1 < operators.index("Pick(o2)") < operators.index("Weigh(o2)")
    assert operators.index("LookAt(o2)") < operators.index("Weigh(o2)")
    after_light = next(t for t in play.turns if any(p.cause == "preimage_lost" and not p.layers for p in t.plans))
    assert after_light.decisions[0].plan == ("FindObj(e1, _reg2_, sk(var(o)))", "Place(sk(var(o)), desk)")
    find = operators.index("LookAtRegion(_reg2_)")
    put_down = next(i for i, op in enumerate(operators) if op.startswith("Place(o2"))
    assert operators.index("Weigh(o2)") < find < operators.index("Pick(_o4_)") < operators.index("Weigh(_o4_)")
    assert put_down < operators.index("Pick(_o4_)")
    assert operators[-1] == "Place(_o4_, desk)"
    assert max(len(p.layers) for t in play.turns for p in t.plans) >= 8


def test_an_obstacle_is_placed_where_it_is_not_in_the_way_again(rulebook: Rulebook) -> None:
    play = example()
    play.run()
    assert any(q.startswith("approach place(") and "o1" in q and "pick(" in q for q in play.geometry.asked)


def test_the_end_without_success_gives_the_best_candidate_with_each_property(rulebook: Rulebook) -> None:
    play = example()
    play.found = {}
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert end.conjuncts.keys() >= {"green", "heavy", "soda"}


# ---------------------------------------------------------------- what is remembered and recorded


def agent_like(play: Play, rulebook: Rulebook) -> Agent:
    """Return an agent that knows nothing of what was done in a play, in the same belief."""
    goal = parse_goal(GREEN_TO_TABLE1, rulebook.vocabulary.words(), frozenset(play.belief.things))
    return Agent(goal, rulebook, play.belief, play.geometry, LIMITS)


def test_an_agent_that_recalls_a_memory_remembers_and_decides_what_the_other_one_does(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    play.fails = {"Pick(sodaC)"}
    for step in range(14):
        memory = play.agent.memory(step)
        assert (memory.executed is None) == (step == 0)
        again = agent_like(play, rulebook)
        again.recall(memory)
        assert again.memory(step) == memory
        recalled, turn = again.decide(step), play.agent.decide(step)
        assert (recalled.action, recalled.plans, recalled.end) == (turn.action, turn.plans, turn.end)
        play.carry_out(turn)
    assert play.agent.memory(14).failures
    play.agent.take_stock()
    assert play.agent.memory(14).executed is None


def test_plans_may_change_as_often_as_the_limit_says(rulebook: Rulebook, monkeypatch: pytest.MonkeyPatch) -> None:
    def change_for_ever(agent: Agent, turn: Turn, step: int, _current: Step) -> None:
        turn.plans.append(agent._stack.message(step, Change("refine")))

    monkeypatch.setattr(Agent, "_refine", change_for_ever)
    limits = LIMITS.model_copy(update={"plan_changes": 5})
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), limits=limits)
    play.run()
    assert play.turns[-1].end is not None
    assert play.turns[-1].end.reason.startswith("plans changed 6 times")


def test_the_stack_is_as_deep_as_the_limit_says_and_no_deeper(
    rulebook: Rulebook, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(agent, "MOST_EFFORT", 1)

    def deepest(limit: int) -> int:
        limits = LIMITS.model_copy(update={"hierarchy_depth": limit})
        play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": GREEN}, limits=limits)
        play.run()
        return max(len(plan.layers) for turn in play.turns for plan in turn.plans)

    needed = deepest(16)
    assert needed > 2
    assert [deepest(limit) for limit in (needed + 1, needed, needed - 1)] == [needed, needed, needed - 1]


@pytest.mark.parametrize("effort", [1, agent.MOST_EFFORT])
def test_a_limit_of_searches_is_doubled_before_a_run_ends_for_it_and_the_end_says_so(
    rulebook: Rulebook, monkeypatch: pytest.MonkeyPatch, effort: int
) -> None:
    monkeypatch.setattr(agent, "MOST_EFFORT", effort)
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), limits=LIMITS.model_copy(update={"expansions": 3}))
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.reason.startswith("no plan with a probability of at least 0.0001 reaches the goal; ")
    stopped = re.search(r"; stopped after (\d+) expansions \(1 times limits.expansions\)$", end.reason)
    assert (stopped is not None) == (effort == 1)
    if stopped is not None:
        assert "; not found in detail within the limits: ExamineObj(e1, sodaB), " in end.reason
        assert 3 < int(stopped[1]) in {decision.expansions for decision in play.turns[-1].decisions}


def test_the_end_says_of_each_step_whether_it_was_impossible_or_too_unlikely(rulebook: Rulebook) -> None:
    def reason(floor: float, *impossible: str) -> str:
        limits = LIMITS.model_copy(update={"min_plan_probability": floor})
        play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE}, limits=limits)
        play.geometry.impossible = set(impossible)
        play.run()
        assert play.turns[-1].end is not None
        return play.turns[-1].end.reason

    looks = [f"look(soda{name})" for name in "EBC"]
    assert "found impossible in the believed world: ExamineObj(e1, sodaB)" in reason(1e-4, *looks)
    assert "too unlikely" not in reason(1e-4, *looks)
    assert "; too unlikely in detail: ExamineObj(e1, sodaC)" in reason(0.1)


def test_a_run_that_ends_for_a_budget_says_so_and_calls_nothing_impossible(rulebook: Rulebook) -> None:
    """Neither the drive whose search was given up, nor what would have needed it, was shown to be impossible."""
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    play.geometry.impossible = {"pick(right, sodaC)", "pick(left, sodaC)"}
    play.geometry.spent = {"pick(right, sodaC)": 44, "pick(left, sodaC)": 7}
    play.run()
    end = play.turns[-1].end
    assert end is not None
    tried = "Move(pick(left,sodaC)) (tried 7 stances), Move(pick(right,sodaC)) (tried 44 stances)"
    assert f"; budget of the motion planner spent: {tried}" in end.reason
    assert "impossible" not in end.reason
    assert re.search(r"; not found in detail within the limits: .*Pick\(sodaC\)", end.reason)


def test_what_fails_for_an_action_without_success_is_not_called_impossible(rulebook: Rulebook) -> None:
    limits = LIMITS.model_copy(update={"repeats": 2})
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN}, limits=limits)
    play.fails = {"Pick(sodaC)"}
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert "without success 2 times: pick(left,sodaC), pick(right,sodaC)" in end.reason
    assert "impossible" not in end.reason


def test_what_is_too_implausible_to_be_tried_is_named_with_its_limit(rulebook: Rulebook) -> None:
    def reason(least: float) -> str:
        limits = LIMITS.model_copy(update={"min_plausible": least})
        play = Play(
            rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": RED}, limits=limits
        )
        play.run()
        assert play.turns[-1].end is not None
        return play.turns[-1].end.reason

    assert re.search(r"is below 0.04 \(limits.min_plausible\): .*sodaB", reason(0.04))
    assert "min_plausible" not in reason(0.0)


def test_a_decision_records_its_own_calls_and_atoms_and_how_near_its_plan_is_to_the_best(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    several = 0
    for turn in play.turns_to_the_end():
        offers = play.agent.posed.offers
        assert sum(decision.clingo_calls for decision in turn.decisions) <= offers.calls
        assert sum(decision.ground_atoms for decision in turn.decisions) <= offers.ground_atoms
        assert all(decision.within is not None and decision.within >= 1.0 for decision in turn.decisions)
        several += len(turn.decisions) > 1
    assert several


@pytest.mark.parametrize(("hue", "cause"), [(GREEN, "done"), (RED, "giveup")])
def test_the_last_plan_says_whether_the_goal_was_reached(rulebook: Rulebook, hue: float, cause: str) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, three_sodas(), dict.fromkeys(("sodaE", "sodaB", "sodaC"), hue))
    play.run()
    assert play.turns[-1].plans[-1].cause == cause


def test_a_step_that_this_robot_cannot_do_is_refused_for_what_it_lacks_and_never_planned_again() -> None:
    rules = Rulebook.load(Queries, [DATA / "own_rules" / "weigh_left.lp"])
    things = {
        "table1": Thing({"table": 1.0}),
        "table2": Thing({"table": 1.0}),
        "can": Thing({"soda": 1.0}, on="table2"),
    }
    goal = "exists o. B(Den(lambda x. Heavy(x), o), 0.9) & B(In(o, table1), 0.9)"
    play = Play(rules, goal, things, log_kg={"can": -0.5})
    play.geometry.impossible = {"pick(right, can)"}
    play.run()
    refused = [plan.false_fluents for turn in play.turns for plan in turn.plans if plan.cause == "refused"]
    assert refused.count(("balance(can)", "held(right,can)")) == 1
    end = play.turns[-1].end
    assert end is not None
    assert "weigh(can) was asked for with can in the left hand" in end.reason
    assert "without success" not in end.reason
    assert list(play.agent.memory(0).objections) == ["balance(can)"]
