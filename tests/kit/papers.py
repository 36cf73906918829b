"""Shared parts of the tests of the paper's items: rules, posed goals, a handling robot, and the paper's example.

The example is that of section "Illustrative example". `rehearsed` keeps finished plays, as several tests read them.
"""

import math
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from kit.minds import Region, TableBelief, TableGeometry, Thing
from kit.plays import BLUE, GREEN, RED, Play
from kit.searches import ROBOT, TYPES, Searcher, detection, table_prior

from skolem.reasoner.language.parser import parse_goal, parse_lambda
from skolem.reasoner.planning.denotation import evaluate
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.planning.goals import PosedGoal, read_mutexes
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.regression import Found, Step, regress
from skolem.reasoner.protocols import BeliefQueries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import nll, parse_term
from skolem.reasoner.worlds.circuits import compile_description
from skolem.sim.symbolic.view import Solid
from skolem.traces.messages import (
    Action,
    ActionResult,
    ColourMeaning,
    Command,
    Detection,
    LookAt,
    MoveBase,
    Observation,
    Pick,
    Place,
    Plan,
    Pose2,
    Pose4,
    Prior,
    PriorObject,
    PriorRegion,
    Weigh,
    WeightInterval,
    Wrench,
)

NINE = nll(0.9)
HEAVY = WeightInterval(at_least_kg=0.4)
STANDS: Pose4 = (1.0, 0.0, 0.7, 0.0)  # a place on the table of `searches`
GREEN_SODA = "exists o. B(Den(lambda x. Green(x) & Soda(x), o), 0.9) & B(On(o, table1), 0.9)"


@cache
def shipped() -> Rulebook:
    """Return the rules that ship, loaded once."""
    return Rulebook.load(Queries)


def with_own_rules(folder: Path, text: str) -> Rulebook:
    """Return the rules with a user's own rule file."""
    path = folder / "own.lp"
    path.write_text(text, encoding="utf-8")
    return Rulebook.load(Queries, [path])


def colour(word: str) -> ColourMeaning:
    """Return the meaning of a colour word."""
    meaning = shipped().vocabulary.meanings[word]
    assert isinstance(meaning, ColourMeaning)
    return meaning


def green() -> ColourMeaning:
    """Return the meaning of the word green."""
    return colour("green")


# ---------------------------------------------------------------- a goal in a belief


def posed(
    goal: str, belief: BeliefQueries, rulebook: Rulebook | None = None, geometry: TableGeometry | None = None
) -> PosedGoal:
    """Return a goal posed of a belief, by default with the geometry `TableGeometry`."""
    book = rulebook or shipped()
    parsed = parse_goal(goal, book.vocabulary.words(), belief.anchors())
    denotations = Denotations(parsed, book)
    return PosedGoal(parsed, book, denotations, belief, geometry or TableGeometry(), read_mutexes(book))


def holds(fluent: str, belief: BeliefQueries, goal: str = GREEN_SODA) -> bool:
    """Return whether a fluent is true in a belief; e1 is the description of `goal`."""
    return posed(goal.replace("table1", belief.anchors()[0]), belief).situation.holds(parse_term(fluent))


def denotes(description: str, belief: BeliefQueries) -> dict[str, float]:
    """Return P(Den) of a description for every anchor."""
    book = shipped()
    circuit = compile_description(parse_lambda(description, book.vocabulary.words(), belief.anchors()), book)
    return evaluate(circuit, belief, book.vocabulary)


def planned(at: PosedGoal, *fluents: str, level: int = 0) -> Found:
    """Return the plan for a conjunction, with all operations at one level of detail."""
    root = frozenset(map(parse_term, fluents))
    return regress([root], at.offers, lambda _: level, lambda *_: False, 3000, 50_000_000)


def steps_of(found: Found) -> tuple[Step, ...]:
    """Return the steps of a plan; there must be a plan."""
    assert found.steps is not None
    return found.steps


def results(instance: Instance) -> set[str]:
    """Return the results of a rule instance as text."""
    return set(map(str, instance.results))


def preconditions(instance: Instance) -> set[tuple[str, int]]:
    """Return the preconditions of a rule instance as text, each with the level that demands it."""
    return {(str(fluent), level) for fluent, level in instance.preconditions}


def only(at: PosedGoal, fluent: str) -> Instance:
    """Return the one rule instance that achieves a fluent."""
    (instance,) = at.offers.offers(parse_term(fluent))
    return instance


def normal_tail(threshold: float, mean: float, sd: float) -> float:
    """Return P(x >= threshold) of a Gaussian."""
    return 0.5 * math.erfc((threshold - mean) / sd / math.sqrt(2.0))


def median_kg(p_heavy: float, sd: float) -> float:
    """Return the median, kg, of a log-normal weight with P(weight >= 400 g) = `p_heavy`, by bisection."""
    low, high = 1e-3, 10.0
    for _ in range(80):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if normal_tail(math.log(0.4), math.log(middle), sd) > p_heavy else (middle, high)
    return middle


# ---------------------------------------------------------------- a robot with a real belief


class Handler(Searcher):
    """The robot of `searches`, which also drives, picks, places and weighs; its results are exact unless stated."""

    def do(self, command: Command, args: Sequence[str] = (), seen: Observation | None = None, **result: object) -> None:
        """Carry out one action and take in its result and observation."""
        self.belief.update(
            Action(step=self.step, op=command.kind, args=tuple(args), command=command),
            ActionResult.model_validate({"step": self.step, "status": "done", "robot": ROBOT} | result),
            seen or Observation(step=self.step, kind="none"),
        )
        self.step += 1

    def see(self, *detections: Detection) -> None:
        """Look without a depth image, so that objects without a detection may be out of sight."""
        looked = Observation(step=self.step, kind="look", detections=detections)
        self.do(LookAt(pan=0.0, tilt=0.0), seen=looked)

    def drive(self, start_T_end: Pose2) -> None:
        """Drive by a motion, which the odometry reports exactly."""
        self.do(MoveBase(start_T_waypoint=(start_T_end,)), odometry=start_T_end)

    def pick(self, anchor: str) -> None:
        """Close the right hand on an object at its believed place."""
        x, y, _, _ = self.belief.snapshot(0).objects[anchor].world_T_object
        command = Pick(hand="right", approach=(), reach=(), lift=(), carry=(), tool_T_object=(0.0, 0.0, -0.05, 0.0))
        self.do(command, (anchor,), base_T_tool=(x, y, 0.75, 0.0), gripper_gap_m=0.06)

    def place(self, anchor: str, support: str, base_T_object: Pose2) -> None:
        """Open the right hand so that the object stands at `base_T_object`."""
        x, y, theta = base_T_object
        command = Place(hand="right", approach=(), lower=(), retreat=(), carry=())
        self.do(command, (anchor, support), base_T_tool=(x, y, 0.75, theta), gripper_gap_m=0.08)

    def weigh(self, kg: float) -> None:
        """Weigh the object in the right hand."""
        wrench = Wrench(hand="right", force_newton=(0.0, 0.0, -9.81 * kg), samples=48)
        self.do(Weigh(hand="right"), seen=Observation(step=self.step, kind="weigh", wrench=wrench))


def seen_as(
    world_T_object: Pose4, kind: str = "soda", rgb: tuple[float, float, float] = (0.08, 0.64, 0.08)
) -> Detection:
    """Return the detection of an object by a robot at the origin of the world."""
    return detection(Solid("it", TYPES[kind], world_T_object)).model_copy(update={"rgb": rgb})


def at_five_percent(
    objects: Sequence[PriorObject] = (), regions: Sequence[PriorRegion] | None = None, **noise: float
) -> Prior:
    """Return the prior of `searches` with a detector that reports the true type in 95 of 100 detections."""
    before = table_prior(objects=objects, regions=regions)
    return before.model_copy(update={"noise": before.noise.model_copy(update={"type_right": 0.95} | noise)})


def can(anchor: str = "can1", soda: float = 0.8, world_T_object: Pose4 = STANDS, sd_m: float = 0.02) -> PriorObject:
    """Return an object on the table that is a soda with probability `soda`, else a bottle."""
    return PriorObject(
        anchor=anchor,
        type={"soda": soda, "bottle": 1.0 - soda},
        world_T_object=world_T_object,
        sd_xy_m=sd_m,
        sd_theta_rad=1.8,
        support="table1",
    )


# ---------------------------------------------------------------- plays


def three_sodas() -> dict[str, Thing]:
    """Return the start of the paper's first two simulations: three sodas on three tables, colours unknown."""
    tables = {f"table{k}": Thing({"table": 1.0}, pose_sd=0.005) for k in (1, 2, 3)}
    sodas = zip(("sodaE", "sodaB", "sodaC"), tables, strict=True)
    return tables | {name: Thing({"soda": 0.95, "bottle": 0.05}, on=table) for name, table in sodas}


GREEN_TO_TABLE1 = "exists o. B(Den(lambda x. Green(x), o), 0.9) & B(In(o, table1), 0.9)"
HUES = {"sodaE": RED, "sodaB": BLUE, "sodaC": GREEN}


def searching() -> Play:
    """Return the paper's third simulation: tables known, no object; the green soda is on the second table."""
    things = {name: thing for name, thing in three_sodas().items() if name.startswith("table")}
    found = {
        "_reg1_": {"_o1_": Thing({"soda": 0.9, "bottle": 0.1}, on="table1", hsv=(RED, 0.9, 0.8), hsv_sd=0.01)},
        "_reg2_": {"_o2_": Thing({"soda": 0.9, "bottle": 0.1}, on="table2", hsv=(GREEN, 0.9, 0.8), hsv_sd=0.01)},
    }
    regions = {f"_reg{k}_": Region(f"table{k}", objects=1.0) for k in (1, 2, 3)}
    return Play(shipped(), GREEN_TO_TABLE1, things, regions=regions, found=found)


EXAMPLE_GOAL = "exists o. B(Den(lambda x. Soda(x) & Green(x) & Heavy(x), o), 0.9) & B(On(o, desk), 0.9)"


def example(p_heavy: float = 0.316, p_exists: float = 0.1, log_weight_sd: float = 0.6) -> Play:
    """Return the paper's example: o1, a box, before o2, a light can; o4, a heavy one, out of sight in another region.

    Args:
        p_heavy: P(weight >= 400 g) of an arbitrary object.
        p_exists: P(there is a heavy green can in the region).
        log_weight_sd: Sd of ln(kg) of an arbitrary object.
    """
    log_kg = (math.log(median_kg(p_heavy, log_weight_sd)), log_weight_sd)

    def thing(kind: str, p: float, hue: float) -> Thing:
        other = "soda" if kind == "carton" else "bottle"
        hsv = (hue, 0.8, 0.8)
        return Thing({kind: p, other: 1 - p}, on="side", hsv=hsv, hsv_sd=0.0388, ln_kg=log_kg, pose_sd=0.03)

    things = {
        **{name: Thing({"table": 1.0}, pose_sd=0.005, ln_kg=log_kg) for name in ("desk", "side", "shelf")},
        "o1": thing("carton", 0.92, 0.35),
        "o2": thing("soda", 0.80, 0.35),
        "o3": thing("soda", 0.87, BLUE),
    }
    o4 = thing("soda", 0.91, 0.35)
    o4.on = "shelf"
    play = Play(
        shipped(),
        EXAMPLE_GOAL,
        things,
        log_kg={"o2": math.log(0.1), "_o4_": math.log(0.5)},
        regions={"_reg2_": Region("shelf")},
        found={"_reg2_": {"_o4_": o4}},
        shows_type=lambda a: {"carton": 0.99, "soda": 0.01} if a == "o1" else {"soda": 0.997, "bottle": 0.003},
    )
    play.belief.new.ln_kg = log_kg
    play.belief.spaces["_reg2_"].objects = -math.log(1.0 - p_exists) / _match(play.belief)
    play.geometry.in_the_way = {f"pick({hand}, o2)": ("o1",) for hand in ("right", "left")}
    return play


def _match(belief: TableBelief) -> float:
    """Return P(an arbitrary object is a heavy green can)."""
    words = shipped().vocabulary.meanings
    return float(np.prod([belief.prob_property_of_new(words[word]) for word in ("soda", "green", "heavy")]))


@cache
def rehearsed(name: str = "example") -> tuple[Play, tuple[str, ...]]:
    """Return a finished play and its executed operators; do not change the play."""
    play = searching() if name == "searching" else example()
    if name == "example heavy":  # o2 turns out to be the denoted object
        play.log_kg["o2"] = math.log(0.5)
    return play, tuple(play.run())


def plans(play: Play, *causes: str) -> list[Plan]:
    """Return the changes of the plan stack; only those of the given causes, if there are any."""
    return [plan for turn in play.turns for plan in turn.plans if not causes or plan.cause in causes]


def first_decision(play: Play) -> tuple[str, ...]:
    """Return the operators of the first plan of a play that has not begun."""
    return play.agent.decide(0).decisions[0].plan
