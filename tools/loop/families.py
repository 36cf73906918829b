"""Scenarios that are drawn by family and seed, with the words of the rules that ship."""

from collections.abc import Sequence
from functools import cache

from skolem.reasoner import load_rules
from skolem.sim.families.ranges import FAMILIES
from skolem.sim.families.words import Words
from skolem.sim.families.writing import scenario_text
from skolem.sim.scenario.document import nearest, read_document
from skolem.tools.loop.setup import Setup, compose
from skolem.traces.errors import Fault, InputError

MOST_SURE = 0.99  # the belief that an object exists never exceeds this probability


@cache
def _words() -> Words:
    vocabulary = load_rules().vocabulary
    return Words(vocabulary.types, vocabulary.meanings)


def refuse_unknown(family: str) -> None:
    """Refuse the name of a family that does not exist.

    Raises:
        InputError: With the nearest name of a family.
    """
    if family not in FAMILIES:
        raise InputError([Fault("FAMILY", 0, 0, f"no family '{family}'{nearest(family, FAMILIES)}")])


def drawn_text(family: str, seed: int, bound: float | None = None) -> str:
    """Return the text of the scenario file for a family and a seed.

    Args:
        family: One of the names in `skolem.sim.families.ranges.FAMILIES`.
        seed: From 0.
        bound: The probability that the goal asks for a description's denotation, instead of a drawn one.

    Raises:
        InputError: If there is no such family, or the bound is no probability that can be reached.
    """
    refuse_unknown(family)
    if bound is not None and not 0.0 < bound <= MOST_SURE:
        raise InputError(
            [Fault("--bound", 0, 0, f"expected a probability above 0, at most {MOST_SURE} (got {bound:g})")]
        )
    return scenario_text(family, seed, _words(), bound)


def drawn_setup(family: str, seed: int, bound: float | None, overrides: Sequence[str], world: str) -> Setup:
    """Return the inputs of the run of a drawn scenario; errors as in `drawn_text`.

    Args:
        family: The family.
        seed: Seed of the world and of the run.
        bound: As in `drawn_text`.
        overrides: Changed values of the scenario, each `a.b=value`.
        world: Name of the simulator.
    """
    document = read_document(f"{family} {seed}", drawn_text(family, seed, bound), overrides)
    return compose(document, seed, world)
