"""Rules with the same body joined to one rule, whose head holds all their heads as terms of one atom.

An operator has a rule for each precondition, each fluent it destroys and each cost, all about the same step. clingo
prepares every rule before it grounds it, which is most of its work where rules have few instances. So rules with the
same body are joined if no other rule uses their heads. The packed atom is taken apart again after solving; the answer
is the same to the last atom.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

from skolem.reasoner.rulebook.loading import Line
from skolem.reasoner.rulebook.numbering import PREFIX, Numbered
from skolem.reasoner.rulebook.parts import VARIABLE, Signature, atom_text

PACK: Final = f"{PREFIX}_"  # no predicate of a rule file has that name
_VARIABLE: Final = "V"
# Terms without arithmetic: a computed term may have no value, and would suppress the atoms packed with it.
_GIVEN: Final = re.compile(r"(?:[\w'(),]|(?<![^(,])-(?=\d))*")


@dataclass(frozen=True, slots=True)
class Packable:
    """A rule whose variables are named by their order in its body, so that rules to be joined have equal bodies."""

    rule: Numbered


def packable(rule: Numbered, ends: frozenset[Signature]) -> Packable | None:
    """Return a rule in the form that `packed` joins; None if it must not be joined.

    Args:
        rule: A rule whose head has the question's number as first argument.
        ends: Predicates, as loaded, that are shown and that no rule uses.
    """
    if not rule.flat or (rule.name, len(rule.arguments)) not in ends or not all(map(_GIVEN.fullmatch, rule.arguments)):
        return None
    names: dict[str, str] = {}

    def renamed(terms: Iterable[str]) -> tuple[str, ...]:
        return tuple(
            VARIABLE.sub(lambda found: names.setdefault(found[0], f"{_VARIABLE}{len(names)}"), term) for term in terms
        )

    body = renamed(rule.body)  # first, since the order in the body gives the names
    return Packable(replace(rule, body=body, arguments=renamed(rule.arguments)))


def packed(rules: Iterable[Numbered | Packable]) -> list[Line]:
    """Return the rules with joinable ones joined, and the `#show` statements for the packed atoms."""
    alone: list[Numbered] = []
    groups: dict[tuple[str, ...], list[Numbered]] = {}
    for each in rules:
        if isinstance(each, Packable):
            groups.setdefault(each.rule.body, []).append(each.rule)
        else:
            alone.append(each)
    left = alone + [_pack(group) if len(group) > 1 else group[0] for group in groups.values()]
    sizes = sorted({len(group) + 1 for group in groups.values() if len(group) > 1})
    return [*(Line(f"#show {PACK}/{n}.") for n in sizes), *(Line(str(rule), rule.origin) for rule in left)]


def _pack(group: Sequence[Numbered]) -> Numbered:
    """Return one rule whose head holds the heads of a group as terms after the question's number."""
    said = [atom_text(rule.name.removeprefix(PREFIX), rule.arguments[1:]) for rule in group]
    return replace(group[0], name=PACK, arguments=(group[0].arguments[0], *said))
