"""The reasoner alone: one regression step, its growth with the belief, and the time to the first action."""

import cProfile
import io
import pstats
import statistics
import time
from collections.abc import Callable, Sequence

import clingo
from clingo import ast

from benchmarks.agents import first_action, whole_run
from benchmarks.believed import Imagined
from benchmarks.problems import GOAL, problem
from benchmarks.tables import Table, Target
from skolem.reasoner.denotation import Denotations
from skolem.reasoner.goals import PosedGoal, read_mutexes
from skolem.reasoner.offers import RuleOffers
from skolem.reasoner.parser import parse_goal
from skolem.reasoner.queries import Queries
from skolem.reasoner.rulebook import Asked, Rulebook
from skolem.reasoner.terms import Term, from_symbol, parse_term

OBJECTS = (8, 50, 500, 5000)
OPEN_FLUENTS, CANDIDATES = 16, 8
REPEATS = 20
LEAST_STATEMENTS = 150
STEP_MS, GROWTH, CALLS = 5.0, 1.5, 30
FIRST_S = {3: 0.10, 10: 0.10, 30: 0.20, 100: 1.0, 300: 2.0, 3000: 10.0}
WORST_LINES = 12  # of a profile


def step(rulebook: Rulebook) -> Table:
    """Return the table of one regression step: what the rules offer for all open fluents of a subgoal."""
    statements = sum(len(found) for _, found in rulebook.sources)
    rows: list[list[object]] = []
    medians: list[float] = []
    subgoal = _subgoal()
    for n in OBJECTS:
        at, milliseconds = _posed(n, rulebook), []
        queries = Queries(at.situation, {"e1": (("can", "green", "heavy"),)})
        for _ in range(REPEATS):
            offers = RuleOffers(rulebook, at.situation, queries, at.offers.mutexes)
            begun = time.process_time()
            offers.prepare(subgoal)
            milliseconds.append(1e3 * (time.process_time() - begun))
        offered = sum(len(offers.offers(fluent)) for fluent in subgoal)
        medians.append(statistics.median(milliseconds))
        growth, apart = medians[-1] / medians[0], _one_by_one(rulebook, queries, subgoal)
        ratio = f"{apart / medians[-1]:.1f}x"
        rows.append([n, f"{medians[-1]:.2f}", f"{growth:.2f}", ratio, offered, offers.calls, offers.ground_atoms])
    return Table(
        "One regression step",
        f"CPU time of asking what the rules offer for the {OPEN_FLUENTS} open fluents of a subgoal about {CANDIDATES} "
        f"objects, under {statements} rule statements; median of {REPEATS}, the belief warm. Of the "
        "rules only those that can fire are loaded, and all open fluents are asked about in one call; beside it, how "
        "many times as long it takes to ask about each alone, of all rules.",
        ["known objects", "ms", "growth", "one by one, all rules", "instances", "clingo calls", "ground atoms"],
        rows,
        [
            Target(f"at least {LEAST_STATEMENTS} statements", statements >= LEAST_STATEMENTS, str(statements)),
            Target(f"at most {STEP_MS:g} ms", max(medians) <= STEP_MS, f"{max(medians):.2f} ms"),
            Target(f"growth of at most {GROWTH:g} from 8 to 5,000 objects", growth <= GROWTH, f"{growth:.2f}"),
        ],
        [] if max(medians) <= STEP_MS and growth <= GROWTH else [_profile(lambda: at.offers.prepare(subgoal))],
    )


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
    """Return the table of times from a belief to the first primitive action."""
    whole_run(problem(3, "a", 0), rulebook)
    rows: list[list[object]] = []
    targets: list[Target] = []
    notes: list[str] = []
    for n, limit_s in FIRST_S.items():
        for state in ("a", "b"):
            given = problem(n, state, 0)
            thought = [first_action(given, rulebook) for _ in range(1 if n > 300 else 3)]
            best = thought[0] if n > 300 else first_action(given, rulebook, optimal=True)
            seconds = statistics.median(each.first_s for each in thought)
            expansions = sum(decision.expansions for decision in thought[0].decisions)
            factors = [decision.within for decision in thought[0].decisions]
            within = ", ".join("?" if factor is None else f"{factor:.2f}" for factor in factors)
            optimal = "-" if n > 300 else f"{best.first_s:.3f}"
            rows.append([n, state, f"{seconds:.3f}", thought[0].clingo_calls, expansions, within, optimal])
            targets.append(
                Target(f"n = {n}, state {state}: at most {limit_s:.2f} s", seconds <= limit_s, f"{seconds:.3f} s")
            )
            if seconds > limit_s:
                notes.append(_profile(lambda given=given: first_action(given, rulebook)))  # type: ignore[misc]
            if n == 3:
                calls = thought[0].clingo_calls
                targets.append(
                    Target(f"at most {CALLS} clingo calls, n = {n}, state {state}", calls <= CALLS, str(calls))
                )
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


def _posed(n: int, rulebook: Rulebook) -> PosedGoal:
    """Return the goal posed of a belief in n objects of which eight may be meant."""
    believed = Imagined(problem(n, "a", 0))
    for k, name in enumerate([name for name, thing in believed.things.items() if not thing.table]):
        share = 0.8 if k < CANDIDATES else 0.0
        believed.tell(name, can=share, green=share)
    goal = parse_goal(GOAL, rulebook.vocabulary.words(), believed.anchors())
    denotations = Denotations(goal.expressions, rulebook)
    return PosedGoal(goal, rulebook, denotations, believed, believed, read_mutexes(rulebook))


def _subgoal() -> tuple[Term, ...]:
    """Return sixteen fluents, two about each of eight objects."""
    fluents = [f"b(den(e1,o{k}),105361)" for k in range(1, CANDIDATES + 1)]
    fluents += [f"b(on(o{k},desk),105361)" for k in (1, 2, 3)] + ["bn(pose(o4),any,sd(8,8,any),any,223144)"]
    fluents += [f"bn(colour(o{k}),v(350,800,800),sd(20,20,20),tol(90,190,190),693147)" for k in (5, 6)]
    fluents += ["holding(o7)", "b(supposed(heavy,o8),35120)"]
    assert len(fluents) == OPEN_FLUENTS, "as the table says"
    return tuple(map(parse_term, fluents))


def _profile(work: Callable[[], object]) -> str:
    """Return where the time of some work goes, as a block of text."""
    profiler = cProfile.Profile()
    profiler.runcall(work)
    text = io.StringIO()
    pstats.Stats(profiler, stream=text).strip_dirs().sort_stats("tottime").print_stats(WORST_LINES)
    return f"```\n{text.getvalue().strip()}\n```"


def tables() -> list[Table]:
    """Return every table of the reasoner alone."""
    rulebook = Rulebook.load(Queries)
    return [step(rulebook), first_actions(rulebook)]
