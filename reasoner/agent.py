"""One turn of the robot's mind: check the goal, keep or drop plans, plan, and name the next action.

Everything it does with a belief is written down in the `Turn` it returns: plans, searches, the action or the end.
"""

import itertools
import math
from dataclasses import dataclass, field

from skolem.reasoner.denotation import Denotations
from skolem.reasoner.expressions import Goal
from skolem.reasoner.hierarchy import Binding, Change, PlanStack
from skolem.reasoner.instances import title
from skolem.reasoner.offers import RuleOffers
from skolem.reasoner.patterns import Mutexes
from skolem.reasoner.protocols import Activity, BeliefQueries, Geometry
from skolem.reasoner.queries import Queries
from skolem.reasoner.regression import Found, Step, Subgoal, regress
from skolem.reasoner.rulebook import Rulebook
from skolem.reasoner.situation import Situation
from skolem.reasoner.terms import Compound, Term, compound, nll, substitute
from skolem.traces.errors import InternalError
from skolem.traces.messages import Action, Command, Decision, Limits, Plan, PlanCause, RunEnd, RunStatus


@dataclass(slots=True)
class Turn:
    """What one decision wrote down, and its outcome: an action or the end of the run."""

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
        self._variables = tuple(compound("var", name) for name in goal.variables)
        self._denotations = Denotations(goal.expressions, rulebook)
        self._mutexes: Mutexes | None = None
        self._refused: set[tuple[Term, int]] = set()
        self._version = -1
        self._renew()

    def decide(self, step: int) -> Turn:
        """Return the next action, or the end of the run, for the belief as it is now."""
        if self._belief.version != self._version:
            self._renew()
        turn = Turn()
        if self._achieved() is not None:
            self._finish(turn, step, "goal_achieved", "every conjunct of the goal is believed")
        elif step >= self._limits.steps:
            self._finish(turn, step, "limit_reached", f"{step} actions were executed (limits.steps)")
        else:
            self._advance(turn, step)
        return turn

    # ------------------------------------------------------------ one belief

    def _renew(self) -> None:
        self._version = self._belief.version
        self._refused.clear()
        self._situation = Situation(
            self._belief,
            self._geometry,
            lambda expression, anchor: self._denotations.probability(expression, anchor, self._belief),
            lambda expression, region: self._denotations.probability_of_new(expression, region, self._belief),
            self._rulebook.vocabulary.meanings,
        )
        queries = Queries(self._situation, self._denotations.alternatives)
        if self._mutexes is None:
            answer = self._rulebook.solve([], queries)
            self._mutexes = Mutexes((f, g) for f, g in answer.atoms.get("mutex", []))
        self._offers = RuleOffers(self._rulebook, self._situation, queries, self._mutexes)
        self._roots: tuple[Subgoal, ...] | None = None

    def _instantiations(self) -> tuple[Subgoal, ...]:
        """Return the goal once per choice of what its variables stand for, as the rules offer them."""
        if self._roots is None:
            facts = [compound("posed", f) for f in self._goal.fluents] + [compound("open", v) for v in self._variables]
            offered = self._offers.ask(facts).get("instance", []) if self._variables else []
            places = {anchor: i for i, anchor in enumerate(self._situation.anchors())}
            choices = [
                sorted((t for v, t in offered if v == variable), key=lambda t: places.get(str(t), len(places)))
                for variable in self._variables
            ]
            self._roots = tuple(
                frozenset(substitute(f, dict(zip(self._variables, chosen, strict=True))) for f in self._goal.fluents)
                for chosen in itertools.product(*choices)
            )
        return self._roots

    def _holds_all(self, fluents: Subgoal) -> bool:
        """Test a conjunction, geometry last: it is the dearest to ask."""
        ordered = sorted(fluents, key=lambda f: (isinstance(f, Compound) and f.name == "at", str(f)))
        return all(map(self._situation.holds, ordered))

    def _satisfied(self, fluents: Subgoal) -> Binding | None:
        """Return under which binding of Skolem constants a conjunction holds; one anchor must satisfy all of it."""
        constants = sorted({s for f in fluents for s in _skolems(f)}, key=str)
        if not constants:
            return {} if self._holds_all(fluents) else None
        for anchors in itertools.permutations(self._situation.anchors(), len(constants)):
            binding: dict[Term, Term] = dict(zip(constants, anchors, strict=True))
            if self._holds_all(frozenset(substitute(f, binding) for f in fluents)):
                return binding
        return None

    def _achieved(self) -> Subgoal | None:
        return next((root for root in self._instantiations() if self._holds_all(root)), None)

    # ------------------------------------------------------------ planning

    def _advance(self, turn: Turn, step: int) -> None:
        """Refine until the chosen step can be executed, or no plan is left."""
        while turn.action is None and turn.end is None:
            self._drop_what_no_longer_applies(turn, step)
            current = self._stack.current()
            if current is None:
                self._plan(turn, step, self._instantiations(), "start")
                if not len(self._stack):
                    self._give_up(turn, step)
            elif current.is_concrete:
                self._execute(turn, step, current)
            else:
                self._refine(turn, step, current)

    def _refine(self, turn: Turn, step: int, current: Step) -> None:
        """Plan for the chosen step's subgoal one level deeper: with the same operation if that can be, else anyhow."""
        for final in (current.instance.called, None):
            if self._stack.current() is current and len(self._stack) < self._limits.hierarchy_depth:
                self._plan(turn, step, (current.subgoal,), "refine", final)
        if self._stack.current() is current:
            self._refuse(turn, step, current)

    def _drop_what_no_longer_applies(self, turn: Turn, step: int) -> None:
        def false_in(fluents: Subgoal) -> list[Term]:
            return [f for f in fluents if not self._situation.holds(f)]

        while changes := self._stack.select(self._satisfied, false_in):
            turn.plans.extend(self._stack.message(step, change) for change in changes)

    def _plan(
        self, turn: Turn, step: int, roots: tuple[Subgoal, ...], cause: PlanCause, final: Term | None = None
    ) -> None:
        calls, atoms = self._offers.calls, self._offers.ground_atoms
        found = regress(
            roots,
            self._offers,
            self._stack.level_of,
            lambda instance, level: (instance.called, level) in self._refused,
            self._limits.expansions,
            nll(self._limits.min_plan_probability),
            final,
        )
        calls, atoms = self._offers.calls - calls, self._offers.ground_atoms - atoms
        turn.decisions.append(self._decision(step, roots, found, calls, atoms))
        if found.steps:
            self._stack.push(found.steps)
            turn.plans.append(self._stack.message(step, Change(cause)))

    def _decision(self, step: int, roots: tuple[Subgoal, ...], found: Found, calls: int, atoms: int) -> Decision:
        return Decision(
            step=step,
            belief_version=self._version,
            subgoal=tuple(sorted(map(str, self._goal.fluents if len(roots) != 1 else roots[0]))),
            candidates=found.candidates,
            plan=tuple(title(s.instance.called) for s in found.steps or ()),
            cost=min(found.cost, 50_000_000),
            expansions=found.expansions,
            clingo_calls=calls,
            ground_atoms=atoms,
        )

    def _refuse(self, turn: Turn, step: int, current: Step) -> None:
        """Note that a step cannot be refined or executed in this belief, and plan from the top without it."""
        self._refused.add((current.instance.called, current.level))
        self._stack.clear()
        turn.plans.append(self._stack.message(step, Change("refused", (current.instance.called,))))

    def _execute(self, turn: Turn, step: int, current: Step) -> None:
        command = None if current.instance.executes is None else self._command(current.instance.executes)
        if command is None:
            self._refuse(turn, step, current)
        else:
            turn.action = Action(
                step=step,
                op=title(current.instance.called),
                args=_objects(current.instance.executes),
                command=command,
            )

    def _command(self, executes: Term) -> Command | None:
        if isinstance(executes, Compound) and executes.name == "move":
            activity = self._activity(executes.args[0])
            return None if activity is None else self._geometry.approach(activity)
        activity = self._activity(executes)
        return None if activity is None else self._geometry.ready(activity)

    def _activity(self, term: Term) -> Activity | None:
        return self._situation.activity(term)

    # ------------------------------------------------------------ ends

    def _give_up(self, turn: Turn, step: int) -> None:
        last = turn.decisions[-1]
        floor = self._limits.min_plan_probability
        reason = f"no plan with a probability of at least {floor:g} reaches the goal"
        if self._refused:
            names = ", ".join(sorted({title(name) for name, _ in self._refused}))
            reason += f"; found impossible in the believed world: {names}"
        elif last.expansions >= self._limits.expansions:
            reason += f" within {last.expansions} expansions (limits.expansions)"
        self._finish(turn, step, "goal_unachievable", reason)

    def _finish(self, turn: Turn, step: int, status: RunStatus, reason: str) -> None:
        probability, anchor = self._best_candidate()
        done = status == "goal_achieved"
        self._stack.clear()
        turn.plans.append(self._stack.message(step, Change("done" if done else "giveup")))
        turn.end = RunEnd(
            status=status,
            steps=step,
            reason=reason,
            goal_probability=probability,
            anchor=anchor,
            conjuncts={} if anchor is None else self._conjuncts(anchor),
            regions={region: self._belief.prob_contents(region) for region in self._belief.regions()},
        )

    def _conjuncts(self, anchor: str) -> dict[str, float]:
        """Return the probability of every property the goal's descriptions turn on, for one anchor."""
        found: dict[str, float] = {}
        for expression in self._goal.expressions:
            found |= self._denotations.conjuncts(expression, anchor, self._belief)
        return found

    def _best_candidate(self) -> tuple[float, str | None]:
        """Return the instantiation that is closest to the goal: (product of its probabilities, what it is about)."""
        best, about = -1.0, None
        for root in self._instantiations():
            if any(_skolems(f) for f in root):
                continue
            p = math.prod(self._situation.probability(phi) for phi in _believed(root))
            if p > best:
                best, about = p, _subject(root, self._situation.anchors())
        return max(best, 0.0), about


def _believed(fluents: Subgoal) -> list[Term]:
    """Return what each b(phi, p) of a conjunction is about."""
    return [f.args[0] for f in sorted(fluents, key=str) if isinstance(f, Compound) and f.name == "b"]


def _skolems(term: Term) -> set[Term]:
    if not isinstance(term, Compound):
        return set()
    return {term} if term.name == "sk" else {s for a in term.args for s in _skolems(a)}


def _subject(root: Subgoal, anchors: tuple[str, ...]) -> str | None:
    """Return the object a description of the goal is about, or the first anchor it names."""
    for fluent in sorted(root, key=str):
        match fluent:
            case Compound("b", (Compound(_, args), _)):
                named = [a for a in args if a in anchors]
                if named:
                    return str(named[0])
    return None


def _objects(command: Term | None) -> tuple[str, ...]:
    """Return the anchors a command is about, hands left out."""
    if not isinstance(command, Compound):
        raise InternalError(
            f"an operator executes {command}; expected move(..), look(..), pick(..), place(..), weigh(..)"
        )
    if command.name == "move":
        return _objects(command.args[0])
    return tuple(str(a) for a in (command.args[1:] if command.name == "pick" else command.args))
