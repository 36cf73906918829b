"""The inputs of a run: a scenario and the rules, read and checked."""

import hashlib
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from skolem.estimation import EstimatorConfig
from skolem.reasoner import Goal, load_rules
from skolem.reasoner.language.parser import read_goal
from skolem.reasoner.meaning.evaluations import unvalued
from skolem.reasoner.planning.contradictions import contradictions
from skolem.reasoner.planning.relations import misused, too_sure
from skolem.reasoner.rulebook.book import Rulebook, rule_files
from skolem.sim.scenario.scenario import Document, Scenario, check, load_document
from skolem.tools.loop.worlds import PYBULLET, WorldKind, named
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import Evaluation, ObjectType, RunStart


@dataclass(frozen=True, slots=True)
class Setup:
    """The inputs of a run, read and checked.

    Attributes:
        document: The scenario file.
        scenario: The checked scenario.
        rulebook: The rules that ship and the scenario's own.
        goal: The scenario's goal.
        seed: Seed of every random draw.
        world: The kind of world to run in.
        images: Whether camera images are recorded.
        profile: Whether wall times are recorded.
    """

    document: Document
    scenario: Scenario
    rulebook: Rulebook
    goal: Goal
    seed: int
    world: WorldKind
    images: bool
    profile: bool

    @property
    def types(self) -> dict[str, ObjectType]:
        """Every object type the rules know."""
        return dict(self.rulebook.vocabulary.types)


def prepare(
    path: Path,
    overrides: Sequence[str] = (),
    seed: int | None = None,
    world: WorldKind | str = PYBULLET,
    images: bool = False,
    profile: bool = False,
) -> Setup:
    """Read a scenario and its rules.

    Args:
        path: The scenario file.
        overrides: Changed values of the scenario, each `a.b=value`.
        seed: Instead of the scenario's.
        world: The kind of world to run in, or its name.
        images: Whether camera images are recorded.
        profile: Whether wall times are recorded.

    Raises:
        InputError: With every fault found.
    """
    kind = named(world) if isinstance(world, str) else world
    return compose(load_document(path, overrides), seed, kind, images, profile)


def compose(
    document: Document,
    seed: int | None = None,
    world: WorldKind | str = PYBULLET,
    images: bool = False,
    profile: bool = False,
) -> Setup:
    """Read a scenario's rules and check it.

    Args:
        document: The scenario file.
        seed: Instead of the scenario's.
        world: The kind of world to run in, or its name.
        images: Whether camera images are recorded.
        profile: Whether wall times are recorded.

    Raises:
        InputError: With every fault found.
    """
    kind = named(world) if isinstance(world, str) else world
    if images and not kind.camera:
        raise InputError([Fault("--images", 0, 0, f"the {kind.name} world has no camera; leave out one of the two")])
    rulebook = rules_of(document)
    scenario, goal = understood(document, rulebook)
    return Setup(document, scenario, rulebook, goal, scenario.seed if seed is None else seed, kind, images, profile)


def rules_of(document: Document) -> Rulebook:
    """Return the rules that ship together with the scenario's own, if a run can follow them.

    Raises:
        InputError: With every fault in them.
    """
    own = [rules for rules in document.rules if os.path.isfile(rules)]
    if not own:
        return load_rules()
    from skolem.tools.loop.apart import rulebook_of  # takes time, and most scenarios do without

    sources, faults = rule_files(own)
    if faults:
        raise InputError(faults)
    return rulebook_of(sources)


def evaluation_of(document: Document) -> Evaluation:
    """Return the evaluation that a document asks for; the default where it asks for none that there is."""
    belief = document.values.get("belief")
    return "independent" if isinstance(belief, Mapping) and belief.get("evaluation") == "independent" else "worlds"


def understood(document: Document, rulebook: Rulebook, evaluation: Evaluation | None = None) -> tuple[Scenario, Goal]:
    """Return the scenario of a document and its goal, read with a rulebook.

    Args:
        document: The document.
        rulebook: The rules.
        evaluation: What a probability is; None for what the document says.

    Raises:
        InputError: With every fault found.
    """
    words = rulebook.vocabulary.words()

    goals: list[Goal] = []

    def faults(text: str, names: Collection[str]) -> list[tuple[int, str]]:
        goal, found = read_goal(text, words, names)
        if goal is None or found:
            return found
        goal = replace(goal, evaluation=evaluation or evaluation_of(document))
        goals.append(goal)
        wrong = misused(goal, rulebook.vocabulary) + too_sure(goal, EstimatorConfig().most_sure)
        wrong += contradictions(goal, rulebook.vocabulary) + unvalued(goal, rulebook)
        return [(0, message) for message in wrong]

    scenario = check(document, rulebook.vocabulary.types, faults)
    [goal] = goals  # the check of a scenario without fault has read its goal, once
    return scenario, goal


def run_start(setup: Setup) -> RunStart:
    """Return the start of a run, as its trace records it."""
    return RunStart(
        scenario=setup.scenario.name,
        scenario_sha256=hashlib.sha256(setup.document.effective_text().encode()).hexdigest(),
        rules_sha256=setup.rulebook.sha256,
        robot_sha256=setup.world.robot_sha256(),
        world=setup.world.name,
        seed=setup.seed,
        goal=setup.scenario.goal,
        limits=setup.scenario.limits,
        evaluation=setup.goal.evaluation,
    )
