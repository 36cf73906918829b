"""The queries of `count.lp`, `refute.lp` and `together.lp`: who is counted, and how sure the robot must be of each."""

from collections.abc import Sequence
from itertools import combinations, islice
from math import comb
from typing import Final

from skolem.reasoner.meaning.universe import Counted, Universe
from skolem.reasoner.planning.patterns import mentions
from skolem.reasoner.planning.sharing import evenly, shares
from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.terms import CAP_MICRONATS, Compound, Term, compound, nll, prob
from skolem.traces.messages import Limits

NONE: Final = "none"
MOST_CHOICES: Final = 20  # of objects that together are counted, likeliest first
_SPARE: Final = 4  # objects more than are needed, from which those are chosen
_IGNORED: Final = 0.01  # share of a bound that may be left to what is too unlikely to be looked at


class Counting:
    """Answers about numbers of objects, in one situation."""

    _now: Situation
    _limits: Limits
    _universe: Universe

    def fitting(self, expression: str) -> Term:
        """The description of all objects of which `expression` means the only one; `none` if it means any of them."""
        found = self._universe.counted.get(expression)
        return NONE if found is None else found.fitting

    def members(self, sentence: str, p: int) -> list[Term]:
        """Choices of the objects that a sentence needs, likeliest first: a tuple of anchors and Skolem constants.

        Of many choices, some are kept for each number of objects that nobody has met.
        """
        found = self._universe.counted.get(sentence)
        if found is None:
            return []
        likely = self._likely(found)
        choices: list[Term] = []
        for unmet in range(found.low + 1):
            strangers = tuple(compound("sk", compound("one_of", sentence, i)) for i in range(unmet))
            known = found.low - unmet
            if known <= len(likely) and (not unmet or found.kind is not None):
                few = likely[: known + _SPARE] if comb(len(likely), known) > MOST_CHOICES else likely
                some = islice(combinations(few, known), max(1, MOST_CHOICES // (found.low + 1)))
                choices += [Compound("", (*chosen, *strangers)) for chosen in some]
        return choices

    def needed(self, sentence: str, members: Compound, p: int) -> list[Term]:
        """(what, object or region, share of p) for all that must be believed if the members are those that fit.

        What is fits(E) or stands_on(S) of each member. Where the number is bounded, it is also unlike(E) of each other
        object that may fit, and of a superlative beaten(E). Once all members have been met, none_in(E) of each region
        that may hide one is needed as well.
        """
        found = self._universe.counted[sentence]
        wanted = list(self._of_members(found, members.args))
        if found.high is not None or sentence in self._universe.ranked:
            wanted += self._of_others(sentence, found.fitting, members.args, prob(p))
        parts = shares([cost for _, _, cost in wanted], p)
        return [Compound("", (what, thing, part)) for (what, thing, _), part in zip(wanted, parts, strict=True)]

    def unfitting(self, expression: str) -> list[Term]:
        """The minimal sets of properties that make a description false of an object."""
        return [Compound("", words) for words in self._universe.false[expression]]

    def stands_on(self, expression: str) -> list[Term]:
        """The supports on which an object must stand to fit a description."""
        found = self._universe.about(expression)
        return list(found.on) if found else []

    def stands_off(self, expression: str) -> list[Term]:
        """The supports on which an object must not stand to fit a description."""
        found = self._universe.about(expression)
        return list(found.unless_on) if found else []

    def contents_for(self, expression: str, region: str, p: int) -> Term:
        """-ln of how well a region must be known until P(it hides none that fits) reaches the bound.

        The expected number of hidden objects is in proportion to the hidden share of the region.
        """
        none, known = self.present_in(expression, region), self._now.belief.prob_contents(region)
        hidden = (1.0 - known) * min(1.0, p / none) if none else 1.0
        return nll(1.0 - hidden)

    def present_in(self, expression: str, region: str) -> int:
        """-ln P(a region hides no object that fits a description)."""
        return nll(self._now.probability(Compound("none_in", (expression, region))))

    def evenly(self, p: int, count: int) -> Term:
        """-ln of how sure each of several facts must be, so that all hold however they depend on each other."""
        return evenly(p, count)

    def _likely(self, found: Counted) -> list[str]:
        """Return the anchors that may fit, likeliest first; all that can be moved, if only a place is said."""
        anchors = self._now.anchors()
        if found.kind is None:
            return [a for a in anchors if self._now.belief.graspable(a)]
        priced = sorted((self._fits(found.kind, a), i, a) for i, a in enumerate(anchors))
        return [a for cost, _, a in priced if cost <= nll(self._limits.min_plausible)]

    def _fits(self, expression: str, anchor: str) -> int:
        return nll(self._now.probability(Compound("den", (expression, anchor))))

    def _of_members(self, found: Counted, members: Sequence[Term]) -> list[tuple[Term, Term, int]]:
        wanted: list[tuple[Term, Term, int]] = []
        for member in members:
            if found.kind is not None:
                phi = Compound("den", (found.kind, member))
                wanted.append((compound("fits", found.kind), member, self._cost(phi, member)))
            for support in found.on:
                phi = Compound("on", (member, support))
                wanted.append((compound("stands_on", support), member, self._cost(phi, member)))
        return wanted

    def _cost(self, phi: Compound, member: Term) -> int:
        """Return -ln P of a fact about a member; nothing is believed yet of one that is not met."""
        return nll(self._now.probability(phi)) if isinstance(member, str) else CAP_MICRONATS

    def _of_others(self, name: str, fitting: str, members: Sequence[Term], p: float) -> list[tuple[Term, Term, int]]:
        """Return what must be believed of the objects that are no members, and of regions.

        The places of members that nobody has met are not known yet, so of regions nothing is asked then.
        """
        others = [anchor for anchor in self._now.anchors() if anchor not in members]
        if name in self._universe.ranked:
            phis = [Compound("beaten", (name, anchor, members[0])) for anchor in others]
        else:
            phis = [Compound("unlike", (fitting, anchor)) for anchor in others]
        if not any(mentions(member, "sk") for member in members):
            phis += [Compound("none_in", (fitting, region)) for region in self._now.belief.regions()]
        least = _IGNORED * (1.0 - p) / max(1, len(phis))
        found = [(phi, self._chance(phi, fitting)) for phi in phis]
        return [(compound(phi.name, phi.args[0]), phi.args[1], nll(q)) for phi, q in found if 1.0 - q > least]

    def _chance(self, phi: Compound, fitting: str) -> float:
        """Return P of a statement; a rival is as likely ahead of an object that nobody has met as behind it."""
        if not mentions(phi, "sk"):
            return self._now.probability(phi)
        return 1.0 - 0.5 * self._now.probability(Compound("den", (fitting, phi.args[1])))
