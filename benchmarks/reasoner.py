"""Measurements of the reasoner alone: one regression step, its growth with the belief, and time to the first action."""

import cProfile
import io
import pstats
import statistics
import time
from collections.abc import Callable, Sequence
from functools import partial

import clingo
from clingo import ast

from benchmarks.agents import Thinking, first_action, ready, whole_run
from benchmarks.believed import Imagined
from benchmarks.problems import GOAL, problem
from benchmarks.tables import Table, Target
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.planning.goals import PosedGoal, read_mutexes
from skolem.reasoner.planning.offers import RuleOffers
from skolem.reasoner.planning.queries import Queries, load_rules
from skolem.reasoner.rulebook.asking import Asked
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import Term, from_symbol, parse_term

MOST = 5000
SERIES = ((5, (5, MOST)), (8, (8, 50, 500, MOST)))  # number of objects in the subgoal; numbers of known objects
OPEN_FLUENTS = 16
CANDIDATES = 8
ROUNDS, REPEATS, PAUSE_S = 10, 3, 2.0  # spread over time: the machine may be slower for a second or two
LEAST_STATEMENTS = 150
STEP_MS, GROWTH, CALLS = 5.0, 1.5, 30
FIRST_S = {3: 0.10, 10: 0.10, 30: 0.20, 100: 1.0, 300: 2.0, 3000: 10.0}
WORST_LINES = 10  # printed lines of a profile
_BOUND = "v(350,800,800),sd(20,20,20),tol(90,190,190),693147"  # a colour that makes an object green
_FLUENTS = {  # the forms of a subgoal's fluents
    "den": "b(den(e1,{o}),105361)",
    "on": "b(on({o},desk),105361)",
    "pose": "bn(pose({o}),any,sd(8,8,any),any,223144)",
    "colour": f"bn(colour({{o}}),{_BOUND})",
    "holding": "holding({o})",
    "weight": "b(supposed(heavy,{o}),35120)",
}
_MORE = {  # number of fluents of each other form, in addition to "den" of every object
    5: {"on": 4, "pose": 2, "colour": 2, "holding": 1, "weight": 2},
    8: {"on": 3, "pose": 1, "colour": 2, "holding": 1, "weight": 1},
}


class Steps:
    """One regression step in a belief in `n` objects, of which the first `about` may be meant."""

    def __init__(self, n: int, about: int, rulebook: Rulebook) -> None:
        self.n, self.about = n, about
        self.subgoal = _subgoal(about)
        self._rulebook = rulebook
        self._believed = Imagined(problem(n, "a", 0))
        for k, name in enumerate([name for name, thing in self._believed.things.items() if not thing.table]):
            share = 0.8 if k < about else 0.0
            self._believed.tell(name, can=share, green=share)
        self._goal = parse_goal(GOAL, rulebook.vocabulary.words(), self._believed.anchors())
        self._denotations = Denotations(self._goal, rulebook)
        self._mutexes = read_mutexes(rulebook)
        self._situation = self._posed().situation
        self.queries = Queries(self._situation, self._denotations.alternatives)

    def warm(self) -> RuleOffers:
        """Return empty offers in a belief whose answers are cached."""
        return RuleOffers(self._rulebook, self._situation, self.queries, self._mutexes)

    def fresh(self) -> RuleOffers:
        """Return empty offers in a belief in which only the goal's description has been evaluated."""
        return self._posed().offers

    def _posed(self) -> PosedGoal:
        believed = self._believed
        return PosedGoal(self._goal, self._rulebook, self._denotations, believed, believed, self._mutexes)


def step(rulebook: Rulebook) -> Table:
    """Return the measurements of one regression step: the offers of the rules for all open fluents of a subgoal."""
    statements = sum(len(found) for _, found in rulebook.sources)
    beliefs = [Steps(n, about, rulebook) for about, sizes in SERIES for n in sizes]
    kinds = [
        _Measured("a warm belief", [(each, each.warm) for each in beliefs]),
        _Measured("the first step in a new belief", [(each, each.fresh) for each in beliefs]),
    ]
    for _ in range(ROUNDS):
        for _ in range(REPEATS):
            for kind in kinds:
                kind.repeat()
        time.sleep(PAUSE_S)
    rows: list[list[object]] = []
    for i, steps in enumerate(beliefs):
        cells = [cell for kind in kinds for cell in (kind.text(i), f"{kind.growth(i):.2f}")]
        apart = min(_one_by_one(rulebook, steps.queries, steps.subgoal) for _ in range(REPEATS)) / kinds[0].ms(i)
        offers = steps.warm()
        offers.prepare(steps.subgoal)
        offered = sum(len(offers.offers(fluent)) for fluent in steps.subgoal)
        rows.append([steps.n, steps.about, *cells, f"{apart:.1f}x", offered, offers.calls, offers.ground_atoms])
    return Table(
        "One regression step",
        f"CPU time of asking what the rules offer for the {OPEN_FLUENTS} open fluents of a subgoal, under {statements} "
        f"rule statements: the fastest of {ROUNDS * REPEATS}, taken over half a minute in all beliefs in turn, since "
        "the same step can take up to twice as long a minute later; in brackets the median, which no target is about. "
        "Warm: the belief has been asked before. First: the belief is new, and all that has been asked of it "
        "is whom the description of the goal denotes (that is part of the next table). Growth is over the first belief "
        "with the same subgoal. Of the rules only those that can fire are loaded, and all open fluents are asked about "
        "in one call; beside it, how many times as long as the warm step it takes to ask about each alone, of all "
        "rules.",
        [
            "known objects",
            "subgoal about",
            "ms, warm",
            "growth",
            "ms, first",
            "growth",
            "one by one, all rules",
            "instances",
            "clingo calls",
            "ground atoms",
        ],
        rows,
        [
            Target(f"at least {LEAST_STATEMENTS} statements", statements >= LEAST_STATEMENTS, str(statements)),
            *(target for kind in kinds for target in kind.targets()),
        ],
        [note for kind in kinds for note in kind.notes()],
    )


class _Measured:
    """Times of one kind of step in several beliefs."""

    def __init__(self, kind: str, asked: Sequence[tuple[Steps, Callable[[], RuleOffers]]]) -> None:
        self._kind = kind
        self._asked = asked
        self._taken: list[list[float]] = [[] for _ in asked]
        for steps, offers in asked:
            offers().prepare(steps.subgoal)

    def repeat(self) -> None:
        """Measure one more time in every belief."""
        for (steps, offers), taken in zip(self._asked, self._taken, strict=True):
            asked = offers()
            begun = time.process_time()
            asked.prepare(steps.subgoal)
            taken.append(1e3 * (time.process_time() - begun))

    def ms(self, i: int) -> float:
        """Return the shortest time in the i-th belief, milliseconds."""
        return min(self._taken[i])

    def text(self, i: int) -> str:
        """Return the shortest time and the median in the i-th belief, as text."""
        return f"{self.ms(i):.2f} ({statistics.median(self._taken[i]):.2f})"

    def growth(self, i: int) -> float:
        """Return the ratio of the shortest time in the i-th belief to that in the first one with the same subgoal."""
        about = [steps.about for steps, _ in self._asked]
        return self.ms(i) / self.ms(about.index(about[i]))

    def targets(self) -> list[Target]:
        """Return the targets of speed and growth, with the figures found."""
        small = next(i for i, (steps, _) in enumerate(self._asked) if steps.n == steps.about == CANDIDATES)
        largest = [i for i, (steps, _) in enumerate(self._asked) if steps.n == MOST]
        growth = max(map(self.growth, largest))
        ratios = ", ".join(f"{self.growth(i):.2f} from {self._asked[i][0].about}" for i in largest)
        return [
            Target(
                f"{self._kind} of {CANDIDATES} objects, all of them candidates: at most {STEP_MS:g} ms",
                self.ms(small) <= STEP_MS,
                f"{self.ms(small):.2f} ms",
            ),
            Target(f"{self._kind}: growth of at most {GROWTH:g} to {MOST:,} objects", growth <= GROWTH, ratios),
        ]

    def notes(self) -> list[str]:
        """Return a profile of the last step if a target is missed."""
        if all(target.met for target in self.targets()):
            return []
        steps, offers = self._asked[-1]
        return [
            f"Where the time goes, {self._kind}, {steps.n:,} objects (the profiler slows it down):",
            _profile(partial(offers().prepare, steps.subgoal)),
        ]


def _one_by_one(rulebook: Rulebook, queries: Queries, fluents: Sequence[Term]) -> float:
    """Return the CPU time in milliseconds of one call of clingo per fluent, with all rules loaded each time."""
    left_out = ("denote", "mutex")
    statements = [s for file, found in rulebook.sources if file.name not in left_out for s in found]
    asked, begun = Asked(queries), time.process_time()
    for fluent in fluents:
        control = clingo.Control(["--warn=none"])
        with ast.ProgramBuilder(control) as builder:
            for statement in statements:
                builder.add(statement)
            ast.parse_string(f"goal({fluent}).", builder.add)
        control.ground([("base", [])], context=asked)
        with control.solve(yield_=True) as handle:
            read = [from_symbol(symbol) for model in handle for symbol in model.symbols(shown=True)]
        assert read, "every fluent has an answer"
    return 1e3 * (time.process_time() - begun)


def first_actions(rulebook: Rulebook) -> Table:
    """Return the times from a belief to the first primitive action."""
    whole_run(problem(3, "a", 0), rulebook)
    rows: list[list[object]] = []
    targets: list[Target] = []
    notes: list[str] = []
    for n, limit_s in FIRST_S.items():
        for state in ("a", "b"):
            given = problem(n, state, 0)
            thought = [first_action(given, rulebook) for _ in range(1 if n > 300 else 3)]
            seconds = statistics.median(each.first_s for each in thought)
            first = thought[0]
            best = first if n > 300 else first_action(given, rulebook, optimal=True)
            expansions = sum(decision.expansions for decision in first.decisions)
            factors = [decision.within for decision in first.decisions]
            within = ", ".join("?" if factor is None else f"{factor:.2f}" for factor in factors)
            optimal = "-" if n > 300 else f"{best.first_s:.3f}"
            rows.append([n, state, f"{seconds:.3f}", first.clingo_calls, expansions, within, optimal])
            where = f"n = {n}, state {state}"
            targets.append(Target(f"{where}: at most {limit_s:.2f} s", seconds <= limit_s, f"{seconds:.3f} s"))
            if seconds > limit_s:
                notes += [f"Where the time goes, {where} (the profiler slows it down):"]
                notes += [_profile(ready(given, rulebook)[1])]
            if n == 3:
                calls = first.clingo_calls
                targets.append(Target(f"{where}: at most {CALLS} clingo calls", calls <= CALLS, str(calls)))
                notes += [_calls(first, where)] if calls > CALLS else []
    return Table(
        "From a belief to the first action",
        "CPU seconds of the paper's illustrative example with n known objects (benchmarks/problems.py, seed 0), warm: "
        "evaluating the description, choosing an object or a region, and refining that choice down to a primitive. "
        "`within` is the factor of the optimum that each plan is proved to keep to, plan by plan; the last column is "
        "the time with limits.optimal, where all are 1.",
        ["n", "state", "seconds", "clingo calls", "expansions", "within", "seconds, optimal"],
        rows,
        targets,
        notes,
    )


def _calls(thought: Thinking, where: str) -> str:
    """Return the number of clingo calls of each search before the first action, as text."""
    calls = [
        f"{decision.clingo_calls} for {' & '.join(decision.subgoal)} ({decision.expansions} expansions)"
        for decision in thought.decisions
    ]
    return f"Calls of clingo, {where}: {'; '.join(calls)}."


def _subgoal(about: int) -> tuple[Term, ...]:
    """Return `OPEN_FLUENTS` fluents about the given number of objects."""
    more = [form for form, count in _MORE[about].items() for _ in range(count)]
    fluents = [_FLUENTS["den"].format(o=f"o{k + 1}") for k in range(about)]
    fluents += [_FLUENTS[form].format(o=f"o{k % about + 1}") for k, form in enumerate(more)]
    assert len(set(fluents)) == OPEN_FLUENTS, "as the table says"
    return tuple(map(parse_term, fluents))


def _profile(work: Callable[[], object]) -> str:
    """Return the profile of a function, as a block of text."""
    profiler = cProfile.Profile()
    profiler.runcall(work)
    text = io.StringIO()
    pstats.Stats(profiler, stream=text).strip_dirs().sort_stats("tottime").print_stats(WORST_LINES)
    return f"```\n{text.getvalue().strip()}\n```"


def tables() -> list[Table]:
    """Return every table of the reasoner alone."""
    rulebook = load_rules()
    return [step(rulebook), first_actions(rulebook)]
