"""Whole turns of the reasoner with the real rules, on a belief that is a table."""

from collections.abc import Iterator

import pytest
from minds import TableBelief, TableGeometry, Thing

from skolem.reasoner.agent import Agent, Turn
from skolem.reasoner.parser import parse_goal
from skolem.reasoner.queries import Queries
from skolem.reasoner.rulebook import Rulebook
from skolem.traces.messages import Limits

LIMITS = Limits(steps=60, expansions=2000, hierarchy_depth=16, min_plan_probability=1e-4)
GREEN_TO_TABLE1 = "exists o. B(Den(lambda x. Green(x), o), 0.9) & B(In(o, table1), 0.9)"
HEAVY_SODA = "exists o. B(Den(lambda x. And(Heavy(x), Soda(x)), o), 0.9) & B(In(o, table1), 0.9)"
RED, GREEN, BLUE = 0.99, 0.33, 0.63


@pytest.fixture(scope="module")
def rulebook() -> Rulebook:
    return Rulebook.load(Queries)


def sodas() -> dict[str, Thing]:
    tables = {f"table{k}": Thing({"table": 1.0}, pose_sd=0.005) for k in (1, 2, 3)}
    return tables | {
        "sodaE": Thing({"soda": 0.95, "bottle": 0.05}, on="table1"),
        "sodaB": Thing({"soda": 0.95, "bottle": 0.05}, on="table2"),
        "sodaC": Thing({"soda": 0.95, "bottle": 0.05}, on="table3"),
    }


class Play:
    """An agent in a world in which every action does what it should; looks show `hues`, weighings `kilograms`."""

    def __init__(
        self,
        rulebook: Rulebook,
        goal: str,
        things: dict[str, Thing],
        hues: dict[str, float] | None = None,
        log_kg: dict[str, float] | None = None,
        limits: Limits = LIMITS,
    ) -> None:
        self.belief = TableBelief(things)
        self.geometry = TableGeometry()
        self.hues = hues or {}
        self.log_kg = log_kg or {}
        names = frozenset(things)
        self.agent = Agent(
            parse_goal(goal, rulebook.vocabulary.words(), names), rulebook, self.belief, self.geometry, limits
        )
        self.turns: list[Turn] = []

    def turns_to_the_end(self) -> Iterator[Turn]:
        for step in range(200):
            turn = self.agent.decide(step)
            self.turns.append(turn)
            yield turn
            if turn.end is not None:
                return
            self.carry_out(turn)
        raise AssertionError("the agent never ended")

    def run(self) -> list[str]:
        """Return the operators carried out."""
        return [turn.action.op for turn in self.turns_to_the_end() if turn.action is not None]

    def carry_out(self, turn: Turn) -> None:
        assert turn.action is not None
        obj, command = self.belief.things[turn.action.args[0]], turn.action.command
        match command.kind:
            case "move_base":
                activity = turn.action.op.removeprefix("Move(").removesuffix(")").replace(",", ", ")
                if activity.startswith("place("):
                    activity = f"place({obj.hand}, {', '.join(turn.action.args)})"
                self.geometry.drive(activity)
                for thing in self.belief.things.values():
                    thing.pose_sd = max(thing.pose_sd, 0.03)
            case "look_at":
                obj.pose_sd = 0.004
                obj.types = {"soda": 0.997, "bottle": 0.003}
                if turn.action.args[0] in self.hues:
                    obj.hsv, obj.hsv_sd = (self.hues[turn.action.args[0]], 0.9, 0.8), 0.01
            case "pick":
                obj.hand, obj.on = command.hand, None
            case "place":
                obj.hand, obj.on, obj.pose_sd = None, turn.action.args[1], 0.01
            case "weigh":
                obj.ln_kg = (self.log_kg[turn.action.args[0]], 0.05)
        self.belief.changed()


def test_the_candidates_are_examined_one_after_another_and_the_stack_is_popped_after_each_disappointment(
    rulebook: Rulebook,
) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
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
        "Move(place(sodaC,table1))",
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
    things = sodas()
    things["sodaC"].hsv, things["sodaC"].hsv_sd = (GREEN, 0.8, 0.8), 0.2
    turn = next(iter(Play(rulebook, GREEN_TO_TABLE1, things).turns_to_the_end()))
    assert turn.decisions[0].plan == ("ExamineObj(e1, sodaC)", "Place(sodaC, table1)")


def test_a_heavy_object_is_found_by_weighing_and_is_not_picked_twice(rulebook: Rulebook) -> None:
    weights = {"sodaE": -1.9, "sodaB": -1.8, "sodaC": -0.5}
    play = Play(rulebook, HEAVY_SODA, sodas(), log_kg=weights)
    operators = play.run()
    assert operators[-1] == "Place(sodaC, table1)"
    assert [op for op in operators if op.startswith("Weigh")] == ["Weigh(sodaE)", "Weigh(sodaB)", "Weigh(sodaC)"]
    assert operators.count("Pick(sodaC)") == 1
    assert operators.index("Pick(sodaB)") > max(i for i, op in enumerate(operators) if op.startswith("Place(sodaE"))


def test_an_object_is_looked_at_before_it_is_picked_while_its_pose_is_poorly_known(rulebook: Rulebook) -> None:
    things = sodas()
    things["sodaC"].hsv, things["sodaC"].hsv_sd, things["sodaC"].pose_sd = (GREEN, 0.9, 0.8), 0.01, 0.1
    operators = Play(rulebook, GREEN_TO_TABLE1, things).run()
    assert operators.index("LookAt(sodaC)") < operators.index("Pick(sodaC)")


def test_no_geometry_is_asked_about_a_later_abstract_step_before_the_first_is_done(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    for turn in play.turns_to_the_end():
        if turn.action is not None and turn.action.op == "LookAt(sodaC)":
            break
    assert not [q for q in play.geometry.asked if "pick" in q or "place" in q]


def test_without_a_plan_the_run_ends_with_the_reason_and_the_best_candidate(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": RED})
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert end.goal_probability < 0.1
    assert "no plan" in end.reason


def test_what_the_geometry_cannot_do_is_given_up_without_spinning(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    play.geometry.impossible = {"look(sodaC)", "pick(right, sodaC)", "pick(left, sodaC)"}
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert end.status == "goal_unachievable"
    assert "Move(look(sodaC))" in end.reason


def test_the_limit_of_steps_ends_the_run(rulebook: Rulebook) -> None:
    limits = LIMITS.model_copy(update={"steps": 3})
    play = Play(rulebook, GREEN_TO_TABLE1, sodas(), {"sodaE": RED}, limits=limits)
    play.run()
    end = play.turns[-1].end
    assert end is not None
    assert (end.status, end.steps) == ("limit_reached", 3)


def test_a_goal_that_is_believed_already_needs_no_action(rulebook: Rulebook) -> None:
    things = sodas()
    things["sodaE"].hsv, things["sodaE"].hsv_sd = (GREEN, 0.9, 0.8), 0.01
    assert Play(rulebook, GREEN_TO_TABLE1, things).run() == []


def test_the_threshold_of_the_goal_decides_whether_anything_is_done(rulebook: Rulebook) -> None:
    things = sodas()
    things["sodaE"].hsv, things["sodaE"].hsv_sd = (GREEN, 0.9, 0.8), 0.1
    assert Play(rulebook, GREEN_TO_TABLE1.replace("x), o), 0.9", "x), o), 0.5"), things).run() == []
    assert Play(rulebook, GREEN_TO_TABLE1, things, {"sodaE": GREEN}).run() == ["Move(look(sodaE))", "LookAt(sodaE)"]


def test_the_same_object_must_satisfy_the_whole_goal(rulebook: Rulebook) -> None:
    """One object is green elsewhere, another stands on the table and is red: nothing is achieved yet."""
    things = sodas()
    things["sodaE"].hsv, things["sodaE"].hsv_sd = (RED, 0.9, 0.8), 0.01
    things["sodaC"].hsv, things["sodaC"].hsv_sd = (GREEN, 0.9, 0.8), 0.01
    assert Play(rulebook, GREEN_TO_TABLE1, things).run()[-1] == "Place(sodaC, table1)"


def test_the_cost_of_a_decision_is_counted_in_calls_and_expansions(rulebook: Rulebook) -> None:
    play = Play(rulebook, GREEN_TO_TABLE1, sodas(), {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN})
    play.run()
    for turn in play.turns:
        assert sum(d.clingo_calls for d in turn.decisions) <= 30
        assert sum(d.expansions for d in turn.decisions) <= 200
