"""The reasoner on a problem: up to its first action, and in a whole run in which every action succeeds."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from benchmarks.believed import Imagined
from benchmarks.problems import GOAL, Problem
from skolem.reasoner.agent import Agent, Turn
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.rulebook.book import Rulebook
from skolem.traces.messages import Decision, Limits

LIMITS = Limits(steps=200, expansions=2000, hierarchy_depth=16, min_plan_probability=1e-4)
Deciding = tuple[Agent, Turn]
_Done = TypeVar("_Done")


@dataclass(slots=True)
class Thinking:
    """The effort of the reasoner on a problem.

    Attributes:
        first_s: CPU time from the belief to the first primitive action.
        run_s: CPU time of all decisions until the goal is believed.
        decisions: The searches before the first action.
        choice: The step of the first plan that decides which object is meant.
        cost: Cost of the first plan, the most abstract one, micro-nats.
        clingo_calls: Number of solver calls before the first action.
        actions: Number of executed actions until the goal was believed.
        replans: Number of turns of the run that searched for a plan.
    """

    first_s: float = 0.0
    run_s: float = 0.0
    decisions: tuple[Decision, ...] = ()
    choice: str = ""
    cost: int = 0
    clingo_calls: int = 0
    actions: int = 0
    replans: int = 0


def ready(given: Problem, rulebook: Rulebook, optimal: bool = False) -> tuple[Imagined, Callable[[], Deciding]]:
    """Return a belief, and a function that decides from it up to the first primitive action when it is called."""
    believed = Imagined(given)
    goal = parse_goal(GOAL, rulebook.vocabulary.words(), believed.anchors())
    limits = LIMITS.model_copy(update={"optimal": optimal})

    def think() -> Deciding:
        agent = Agent(goal, rulebook, believed, believed, limits)
        return agent, agent.decide(0)

    return believed, think


def first_action(given: Problem, rulebook: Rulebook, optimal: bool = False) -> Thinking:
    """Return the effort from a belief to the first primitive action."""
    _, think = ready(given, rulebook, optimal)
    (_, turn), seconds = _timed(think)
    return _thought(turn, seconds)


def whole_run(given: Problem, rulebook: Rulebook) -> Thinking:
    """Return the effort from a belief to the goal, if every action has the outcome that the plan expects.

    Raises:
        RuntimeError: If the goal is not reached.
    """
    believed, think = ready(given, rulebook)
    (agent, turn), seconds = _timed(think)
    found = _thought(turn, seconds)
    while turn.end is None:
        assert turn.action is not None
        believed.carry_out(turn.action)
        found.actions += 1
        turn, seconds = _timed(partial(agent.decide, found.actions))
        found.run_s += seconds
        found.replans += bool(turn.decisions)
    if turn.end.status != "goal_achieved":
        raise RuntimeError(f"a run of the benchmark failed: {turn.end.reason}")
    return found


def _timed(work: Callable[[], _Done]) -> tuple[_Done, float]:
    """Return the result of a function, and its CPU time in seconds."""
    begun = time.process_time()
    done = work()
    return done, time.process_time() - begun


def _thought(turn: Turn, seconds: float) -> Thinking:
    top = turn.decisions[0]
    choice = next(op for op in top.plan if op.startswith(("ExamineObj", "FindObj")))
    calls = sum(decision.clingo_calls for decision in turn.decisions)
    return Thinking(seconds, seconds, tuple(turn.decisions), choice, top.cost, calls, replans=1)
