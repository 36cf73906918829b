"""Rules that say more than one thing of the same as one rule: what follows comes in one atom and is taken apart later.

An operator has a rule for each precondition, for each thing it destroys, for its costs, all of the same step. clingo
prepares every rule before it grounds it, which is most of its work where rules have few instances. So rules with the
same body whose heads nothing builds on are joined; what follows from a question is the same to the last atom.
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
# Terms that stand as they are: what is computed may have no value, and takes none with it.
_GIVEN: Final = re.compile(r"(?:[\w'(),]|(?<![^(,])-(?=\d))*")


@dataclass(frozen=True, slots=True)
class Packable:
    """A rule whose variables are named by their order in its body: those that can be one with it have the same body."""

    rule: Numbered


def packable(rule: Numbered, ends: frozenset[Signature]) -> Packable | None:
    """Return a rule for `packed`; None if it has to stay by itself.

    Args:
        rule: With the number of the question as the first argument of its head.
        ends: Predicates, as they are loaded, that are shown and that no rule builds on.
    """
    if not rule.flat or (rule.name, len(rule.arguments)) not in ends or not all(map(_GIVEN.fullmatch, rule.arguments)):
        return None
    names: dict[str, str] = {}

    def renamed(terms: Iterable[str]) -> tuple[str, ...]:
        return tuple(
            VARIABLE.sub(lambda found: names.setdefault(found[0], f"{_VARIABLE}{len(names)}"), term) for term in terms
        )

    body = renamed(rule.body)  # first: they are named in its order
    return Packable(replace(rule, body=body, arguments=renamed(rule.arguments)))


def packed(rules: Iterable[Numbered | Packable]) -> list[Line]:
    """Return rules as fewer ones, and what makes clingo show what they derive."""
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
    """Return one rule that derives what each of a group does, as the terms of one atom after the question's number."""
    said = [atom_text(rule.name.removeprefix(PREFIX), rule.arguments[1:]) for rule in group]
    return replace(group[0], name=PACK, arguments=(group[0].arguments[0], *said))
