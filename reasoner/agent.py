"""One turn of the reasoner: check the goal, keep or drop plans, plan, and name the next action.

The `Turn` that it returns records everything: plans, searches, and the action or the end.

May import: planning.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from skolem.reasoner.language.expressions import Goal
from skolem.reasoner.planning.attempts import Attempts
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.planning.goals import Closest, PosedGoal, read_mutexes
from skolem.reasoner.planning.hierarchy import Change, PlanStack
from skolem.reasoner.planning.instances import Instance, title
from skolem.reasoner.planning.presuppositions import nothing, several, vacuous
from skolem.reasoner.planning.refusals import (
    IMPOSSIBLE,
    IN_VAIN,
    NOT_ENOUGH,
    NOT_FOUND,
    SPENT,
    Refusals,
    why_none,
)
from skolem.reasoner.planning.regression import Found, Step, Subgoal, regress
from skolem.reasoner.planning.remembering import recalled, remembered
from skolem.reasoner.protocols import BeliefQueries, Geometry
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import CAP_MICRONATS, Compound, Term, nll, parse_term
from skolem.traces.errors import RuleError
from skolem.traces.messages import (
    Action,
    Command,
    Decision,
    Denotation,
    Limits as Limits,
    Memory,
    Plan,
    PlanCause,
    RunEnd,
    RunStatus,
)

MOST_EFFORT: Final = 4  # limits of searches are doubled so far before a run is given up for one of them


@dataclass(slots=True)
class Turn:
    """The record of one decision and its outcome: an action or the end of the run."""

    closest: Closest
    denotation: Denotation
    plans: list[Plan] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    action: Action | None = None
    end: RunEnd | None = None


class Agent:
    """Decides, one turn at a time, what to do for a goal.

    Args:
        goal: What the world should be like.
        rulebook: The rules and the words.
        belief: Asked at every turn; its `version` tells whether anything changed.
        geometry: Must be synchronised with the belief before each turn.
        limits: Counts after which the run gives up.

    Attributes:
        denotations: The descriptions of the goal.
        posed: The goal in the belief as it was when stock was last taken.
    """

    def __init__(
        self, goal: Goal, rulebook: Rulebook, belief: BeliefQueries, geometry: Geometry, limits: Limits
    ) -> None:
        self._goal = goal
        self._rulebook = rulebook
        self._belief = belief
        self._geometry = geometry
        self._limits = limits
        self._stack = PlanStack()
        with rulebook.answerable():
            self.denotations = Denotations(goal, rulebook)
            self._mutexes = read_mutexes(rulebook)
        self._refused = Refusals()
        self._stopped = 0  # expansions of the longest search in this belief that ended at its limit
        self._too_deep = False  # whether a step of this belief was not refined, since the stack was as deep as may be
        self._effort = 1  # by which the limits of searches are multiplied in this belief
        self._in_vain: dict[object, str] = {}  # searches without a plan in this belief, and why: more refusals add none
        self._objections: dict[Term, str] = {}  # step -> why the robot cannot do such a thing
        self._attempts = Attempts(limits)
        self._executed: Step | None = None
        self._version = belief.version
        with rulebook.answerable():
            self.posed = self._pose()

    def decide(self, step: int) -> Turn:
        """Return the next action, or the end of the run, for the belief as it is now.

        Raises:
            InputError: If a user's own rules break the contract of rules.
        """
        with self._rulebook.answerable():
            return self._decide(step)

    def _decide(self, step: int) -> Turn:
        self.take_stock()
        turn = Turn(closest=self.posed.closest(), denotation=self._denotation(step))
        if self.posed.achieved() is not None:
            of_nothing = vacuous(self._goal, self.denotations, self._belief)
            self._finish(turn, step, "goal_achieved", "every conjunct of the goal is believed" + of_nothing)
        elif failed := several(self._goal, self.denotations, self._belief):
            self._finish(turn, step, *failed)
        elif step >= self._limits.steps:
            self._finish(turn, step, "limit_reached", f"{step} actions were executed (limits.steps)")
        else:
            self._advance(turn, step)
        return turn

    def take_stock(self) -> None:
        """Pose the goal in the present belief and judge the last action by it; `decide` begins with this."""
        if self._belief.version != self._version:
            self._begin_anew()
        self._judge_last()

    def memory(self, step: int) -> Memory:
        """Return the memory of earlier decisions; the next decision depends on it and on the belief alone."""
        layers, current = self._stack.steps()
        return Memory(
            step=step,
            layers=tuple(tuple(map(remembered, layer)) for layer in layers),
            current=current,
            executed=None if self._executed is None else remembered(self._executed),
            failures=self._attempts.failures(),
            in_vain=self._attempts.in_vain(),
            nearest=self._attempts.nearest(),
            objections={str(impossible): why for impossible, why in sorted(self._objections.items(), key=str)},
        )

    def recall(self, memory: Memory) -> None:
        """Take over what was remembered at a recorded decision, as `memory` returned it."""
        self._stack = PlanStack([[recalled(step) for step in layer] for layer in memory.layers], memory.current)
        self._executed = None if memory.executed is None else recalled(memory.executed)
        self._attempts.recall(memory.failures, memory.in_vain, memory.nearest)
        self._objections = {parse_term(impossible): why for impossible, why in memory.objections.items()}
        self._begin_anew()

    def _begin_anew(self) -> None:
        """Pose the goal in the present belief, and forget the findings about an earlier one."""
        self._version, self.posed = self._belief.version, self._pose()
        self._refused.clear()
        self._in_vain.clear()
        self._stopped, self._too_deep, self._effort = 0, False, 1
        self._mutexes.forget()

    def _pose(self) -> PosedGoal:
        parts = (self._goal, self._rulebook, self.denotations, self._belief, self._geometry, self._mutexes)
        return PosedGoal(*parts, self._attempts.fruitless_here(), self._limits)

    def _denotation(self, step: int) -> Denotation:
        probabilities = {
            name: dict(self.denotations.probabilities(name, self._belief)) for name in self._goal.expressions
        }
        return Denotation(step=step, probability=probabilities)

    # ------------------------------------------------------------ planning

    def _advance(self, turn: Turn, step: int) -> None:
        """Refine until the chosen step can be executed, or no plan is left."""
        while turn.action is None and turn.end is None:
            if len(turn.plans) > self._limits.plan_changes:
                said = f"plans changed {len(turn.plans)} times without an action (limits.plan_changes)"
                self._finish(turn, step, "limit_reached", said)
                return
            self._drop_what_no_longer_applies(turn, step)
            current = self._stack.current()
            if current is None:
                self._plan(turn, step, self.posed.instantiations, "start")
                if not len(self._stack) and not self._try_harder():
                    self._give_up(turn, step)
            elif current.is_concrete:
                self._execute(turn, step, current)
            else:
                self._refine(turn, step, current)

    def _refine(self, turn: Turn, step: int, current: Step) -> None:
        """Plan for the chosen step's subgoal one level deeper: with the same operation if that can be, else anyhow."""
        if len(self._stack) >= self._limits.hierarchy_depth * self._effort:
            self._too_deep = True
            self._refuse(turn, step, current, NOT_FOUND)
            return
        why = IMPOSSIBLE
        for final in (current.instance.operation, None):
            if self._stack.current() is current:
                why = self._plan(turn, step, (current.subgoal,), "refine", final)
        if self._stack.current() is current:
            self._refuse(turn, step, current, why)

    def _try_harder(self) -> bool:
        """Double the limits of searches, if one of them ended a search; return whether planning should go on."""
        if self._effort >= MOST_EFFORT or not (self._stopped or self._too_deep):
            return False
        self._effort *= 2
        self._stopped, self._too_deep = 0, False
        self._in_vain = {search: why for search, why in self._in_vain.items() if why != NOT_FOUND}
        self._refused.forget_limits()
        return True

    def _drop_what_no_longer_applies(self, turn: Turn, step: int) -> None:
        def false_in(fluents: Subgoal) -> list[Term]:
            return [f for f in fluents if not self.posed.situation.holds(f)]

        while changes := self._stack.select(self.posed.satisfied, false_in, self._refused_for(set())):
            turn.plans.extend(self._stack.message(step, change) for change in changes)

    def _plan(
        self, turn: Turn, step: int, roots: tuple[Subgoal, ...], cause: PlanCause, final: Term | None = None
    ) -> str:
        """Push the cheapest plan; or return why there is none."""
        search = (roots, final, self._stack.refined())
        if search in self._in_vain:
            return self._in_vain[search]
        calls, atoms = self.posed.offers.calls, self.posed.offers.ground_atoms
        met: set[str] = set()
        found = regress(
            roots,
            self.posed.offers,
            self._stack.level_of,
            self._refused_for(met),
            self._limits.expansions * self._effort,
            nll(self._limits.min_plan_probability),
            final,
            self._limits.optimal,
        )
        calls, atoms = self.posed.offers.calls - calls, self.posed.offers.ground_atoms - atoms
        turn.decisions.append(self._decision(step, roots, found, calls, atoms))
        if not found.exhausted:
            self._stopped = max(self._stopped, found.expansions)
        if found.steps:
            self._stack.push(found.steps)
            turn.plans.append(self._stack.message(step, Change(cause)))
            return ""
        self._in_vain[search] = why_none(found.exhausted, found.priced_out, met)
        return self._in_vain[search]

    def _decision(self, step: int, roots: tuple[Subgoal, ...], found: Found, calls: int, atoms: int) -> Decision:
        return Decision(
            step=step,
            belief_version=self._version,
            subgoal=tuple(sorted(map(str, self._goal.fluents if len(roots) != 1 else roots[0]))),
            candidates=found.candidates,
            plan=tuple(title(s.instance.operation) for s in found.steps or ()),
            cost=min(found.cost, CAP_MICRONATS),
            within=None if found.within is None else round(found.within, 6),
            expansions=found.expansions,
            clingo_calls=calls,
            ground_atoms=atoms,
        )

    def _refuse(self, turn: Turn, step: int, current: Step, why: str, *lacking: Term, tried: int = 0) -> None:
        """Note that a step cannot be refined or executed in this belief, and drop the plan that it stands in.

        The plans above stay: what they need of this one is planned anew, without the step.
        """
        self._refused.note(current.instance, current.level, why, tried)
        self._stack.pop()
        turn.plans.append(self._stack.message(step, Change("refused", (current.instance.operation, *lacking))))

    def _execute(self, turn: Turn, step: int, current: Step) -> None:
        executes = current.instance.executes
        if executes is None:
            self._drop_inference(turn, step, current)
            return
        if (objection := self.posed.situation.objection(executes)) is not None:
            lacking, self._objections[current.instance.step] = objection
            self._refuse(turn, step, current, IMPOSSIBLE, lacking)
            return
        command = self._command(executes)
        if self._attempts.is_hopeless(executes):
            self._refuse(turn, step, current, IN_VAIN)
        elif command is None:
            tried = self._tried(executes)
            self._refuse(turn, step, current, SPENT if tried else IMPOSSIBLE, tried=tried)
        else:
            self._executed = current
            turn.action = Action(
                step=step,
                op=title(current.instance.operation),
                args=_objects(current.instance.executes),
                command=command,
            )

    def _drop_inference(self, turn: Turn, step: int, current: Step) -> None:
        """Drop the plan of an inference that gives nothing though all holds that it needed when it was planned."""
        if new := self._needed_since(current):
            self._stack.pop()
            turn.plans.append(self._stack.message(step, Change("preimage_lost", new)))
        else:
            self._refuse(turn, step, current, NOT_ENOUGH)

    def _needed_since(self, current: Step) -> tuple[Term, ...]:
        """Return what an inference needs now, but did not when it was planned: an object may have been found since."""
        believed = [f for f in current.subgoal if isinstance(f, Compound) and f.name == "b"]
        false = [f for f in sorted(believed, key=str) if not self.posed.situation.holds(f)]
        offered = (instance for fluent in false for instance in self.posed.offers.offers(fluent))
        same = next((i for i in offered if i.step == current.instance.step), None)
        needed = same.demanded(current.level) if same else []
        return tuple(fluent for fluent in needed if not self.posed.situation.holds(fluent))

    def _refused_for(self, met: set[str]) -> Callable[[Instance, int], bool]:
        """Return a test of whether a step is not to be planned with at a level in this belief; it adds why to `met`."""

        def refused(instance: Instance, level: int) -> bool:
            why = self._why_refused(instance, level)
            met.update({why} if why else ())
            return bool(why)

        return refused

    def _why_refused(self, instance: Instance, level: int) -> str:
        if instance.step in self._objections:
            return IMPOSSIBLE
        return self._refused.reason(instance, level) or IN_VAIN * self._attempts.is_hopeless(instance.executes)

    def _judge_last(self) -> None:
        """Note whether the last action achieved the results that its step promised."""
        if self._executed is not None:
            before = self._attempts.fruitless_here()
            self._attempts.judge(self._executed.instance, self.posed.still_false(self._executed.subgoal))
            self._executed = None
            if self._attempts.fruitless_here() != before:
                self._begin_anew()
                self._stack.clear()  # its subgoal may be known by now, or need more than was planned

    def _command(self, executes: Term) -> Command | None:
        if isinstance(executes, Compound) and executes.name == "move":
            activity = self.posed.situation.activity(executes.args[0])
            return None if activity is None else self._geometry.approach(activity)
        activity = self.posed.situation.activity(executes)
        return None if activity is None else self._geometry.ready(activity)

    def _tried(self, executes: Term | None) -> int:
        """Return after how many stances the motion planner gave up a drive; 0 if it showed that there is none."""
        if not isinstance(executes, Compound) or executes.name != "move":
            return 0
        activity = self.posed.situation.activity(executes.args[0])
        return 0 if activity is None else self._geometry.tried(activity)

    # ------------------------------------------------------------ ends

    def _give_up(self, turn: Turn, step: int) -> None:
        floor = self._limits.min_plan_probability
        reason = f"no plan with a probability of at least {floor:g} reaches the goal"
        reason += self._refused.told()
        reason += "".join(f"; {why}" for _, why in sorted(self._objections.items(), key=str))
        often = list(map(str, self._attempts.hopeless()))
        if often:
            reason += f"; without success {self._limits.repeats} times: {', '.join(sorted(often))}"
        reason += self.posed.left_out()
        if self._stopped:
            reason += f"; stopped after {self._stopped} expansions ({self._effort} times limits.expansions)"
        if self._too_deep:
            depth = self._effort * self._limits.hierarchy_depth
            reason += f"; stopped {depth} plans deep ({self._effort} times limits.hierarchy_depth)"
        failed = nothing(self._goal, self.denotations, self._belief)
        self._finish(turn, step, *(failed or ("goal_unachievable", reason)))

    def _finish(self, turn: Turn, step: int, status: RunStatus, reason: str) -> None:
        done = status == "goal_achieved"
        self._stack.clear()
        turn.plans.append(self._stack.message(step, Change("done" if done else "giveup")))
        turn.end = RunEnd(
            status=status,
            steps=step,
            reason=reason,
            goal_probability=turn.closest.probability,
            anchor=turn.closest.anchor,
            conjuncts=turn.closest.conjuncts,
            regions={region: self._belief.prob_contents(region) for region in self._belief.regions()},
        )


def _objects(command: Term | None) -> tuple[str, ...]:
    """Return the objects in a command: the one it acts on, its support, and the one that must stay accessible."""
    if not isinstance(command, Compound):
        expected = "move(..), look(..), pick(..), place(..), weigh(..)"
        raise RuleError(f"an operator executes {command}; expected {expected}", "executes")
    if command.name == "move":
        return _objects(command.args[0])
    return tuple(str(a) for a in (command.args[1:] if command.name == "pick" else command.args))
