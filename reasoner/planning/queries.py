"""The queries that rules may put to the belief: each public method of `Queries` is an @function of the rule files.

They are pure functions of (belief version, arguments), since clingo may call one several times. Probabilities are
passed as -ln p in integer micro-nats; an empty list means that there is no answer.
"""

import math
from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import Final

from skolem.reasoner.meaning.universe import Universe
from skolem.reasoner.planning import gaussians
from skolem.reasoner.planning.bands import band, expected
from skolem.reasoner.planning.counting import Counting
from skolem.reasoner.planning.relating import Relating
from skolem.reasoner.planning.situation import Situation, hand_named, quantity_named
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import Compound, Term, nll, prob
from skolem.traces.messages import Limits, TypeIs, TypeIsNot

DEFAULTS: Final = Limits()

Alternatives = Mapping[str, tuple[tuple[str, ...], ...]]  # expression -> sets of properties, each enough for it


class Queries(Counting, Relating):
    """Answers for one situation.

    Attributes:
        left_out: Objects and regions that were left out of answers, since they are less plausible than the limit.
    """

    def __init__(
        self,
        situation: Situation,
        alternatives: Alternatives,
        limits: Limits = DEFAULTS,
        universe: Universe | None = None,
    ) -> None:
        self._now = situation
        self._universe = universe or Universe()
        self._alternatives = alternatives
        self._known = frozenset(situation.anchors())
        self._limits = limits
        self.left_out: set[str] = set()

    def anchors(self) -> list[Term]:
        """Every anchor believed to exist."""
        return list(self._now.anchors())

    def rigid(self, obj: Term) -> Term:
        """1 if the term is an anchor and so a rigid designator, else 0."""
        return int(obj in self._known)

    def plausible(self, expression: str) -> list[Term]:
        """The anchors that the description may denote, likeliest first; of the only such thing, all that may be one."""
        counted = self._universe.counted.get(expression)
        likely = counted.fitting if counted else expression
        priced = [(nll(self._den(likely, a)), i, a) for i, a in enumerate(self._now.anchors())]
        return [a for cost, _, a in sorted(priced) if self._is_plausible(a, cost)]

    def present(self, expression: str, anchor: str) -> Term:
        """-ln P_p: the probability that the description denotes the anchor now."""
        return nll(self._den(expression, anchor))

    def searchable(self, expression: str, p: int) -> list[Term]:
        """(region, -ln P(ExistsIn)) for each region that may hold a denoted object and is not known to the bound p."""
        found: list[Term] = []
        for region in () if expression in self._universe.counted else self._now.belief.regions():
            cost = nll(self._now.probability(Compound("exists_in", (expression, region))))
            if nll(self._now.belief.prob_contents(region)) > p and self._is_plausible(region, cost):
                found.append(Compound("", (region, cost)))
        return found

    def blockers(self, activity: Term) -> list[Term]:
        """The movable anchors that block an activity."""
        return list(self._now.blockers(activity))

    def props_for(self, expression: str, anchor: str, p: int) -> list[Term]:
        """PropsFor: the properties of each sufficient set that are not yet believed to an even share of p.

        The whole set is given if those alone do not identify it; the others then add no cost.
        """
        found: list[Term] = []
        for words in self._alternatives[expression]:
            share = p // len(words)
            unsure = [w for w in words if self.believed(w, anchor) > share]
            props = Compound("", tuple(unsure or words))
            found.append(props if self._set_of(expression, props) == words else Compound("", words))
        return found

    def portion(self, expression: str, props: Compound, anchor: str, p: int) -> Term:
        """The part of the bound p for `props`: an even share for each property of the sufficient set they come from."""
        return p * len(props.args) // len(self._set_of(expression, props))

    def settled(self, expression: str, props: Compound) -> list[Term]:
        """The other properties of the sufficient set that `props` comes from, if any; they are believed enough."""
        rest = tuple(word for word in self._set_of(expression, props) if word not in props.args)
        return [Compound("", rest)] if rest else []

    def together(self, props: Compound, anchor: str) -> Term:
        """-ln P(the anchor has each of the properties)."""
        return nll(self._now.probability(Compound("holds", (props, anchor))))

    def doubt(self, anchor: str) -> Term:
        """-ln P(the object exists)."""
        return nll(self._now.belief.prob_exists(anchor))

    def each(self, props: Compound) -> list[Term]:
        """(number of properties, property) for each property."""
        return [Compound("", (len(props.args), word)) for word in props.args]

    def believed(self, word: str, anchor: str) -> int:
        """-ln P(the anchor has the property)."""
        return nll(self._now.prob_word(word, anchor))

    def quantity(self, word: str) -> list[Term]:
        """The quantity of a property: type, colour or weight."""
        meaning = self._now.meanings.get(word)
        return [] if meaning is None else [meaning.quantity]

    def favourable(self, word: str, anchor: str, p: int) -> Term:
        """-ln P(one observation lifts the belief in the property to the bound | the property is true).

        It costs no more than the limit says, since an observation that falls short can be repeated.
        """
        return nll(max(self._limits.min_favourable, self._favourable(word, anchor, p)))

    def band(self, word: str, anchor: str, p: int) -> list[Term]:
        """(mu, Sigma, Delta) of the quantity from which the property follows; empty if the sensor is too weak."""
        meaning = self._now.meanings[word]
        if isinstance(meaning, TypeIs | TypeIsNot):
            return []
        belief, quantity = self._now.belief, meaning.quantity
        sensor = partial(belief.observation_covariance, quantity, anchor)
        found = band(meaning, belief.gaussian(quantity, anchor), sensor, prob(p))
        return [] if found is None else [Compound("", found)]

    def before_look(self, quantity: str, anchor: str, sigma: Term) -> Term:
        """Sigma needed before one observation of the quantity at its mean; `any` if the sensor alone suffices."""
        sensor = self._now.belief.observation_covariance(quantity_named(quantity), anchor)
        return gaussians.before_observation(sigma, sensor)

    def observations(self, quantity: str, anchor: str, mu: Term, sigma: Term, delta: Term) -> list[Term]:
        """The number of observations of a quantity within mu +- delta that lead to sigma; empty if it is too great."""
        named = quantity_named(quantity)
        belief = self._now.belief.gaussian(named, anchor)
        sensor = self._now.belief.observation_covariance(named, anchor, expected(belief, mu, delta))
        count = gaussians.observations(sigma, sensor, belief.covariance)
        return [] if count is None else [count]

    def before_reading(self, anchor: str, word: str, p: int) -> Term:
        """-ln of the belief in a type needed before one favourable look."""
        return nll(gaussians.before_reading(prob(p), self._now.belief.prob_type_right()))

    def detected(self, anchor: str) -> Term:
        """-ln P(a look reports the object)."""
        return nll(self._now.belief.prob_detected(anchor))

    def in_hand(self, hand: str) -> list[Term]:
        """The anchor in that hand, if any."""
        held = self._now.belief.held(hand_named(hand))
        return [] if held is None else [held]

    def graspable(self, thing: Term) -> Term | list[Term]:
        """1 if a hand can close on the anchor's most likely type, else 0; empty for an object that is not met yet."""
        return int(self._now.belief.graspable(str(thing))) if thing in self._known else []

    def supports(self) -> list[Term]:
        """The anchors that objects can be put on: those that no hand can hold."""
        return [a for a in self._now.anchors() if not self._now.belief.graspable(a)]

    def support_of(self, anchor: str) -> list[Term]:
        """The support of an anchor, if that is an anchor."""
        support = self._now.belief.support(anchor)
        return [support] if support in self._known else []

    def standing_on(self, support: Term) -> list[Term]:
        """The anchors that rest on a support."""
        occupied, on = self._rests_on
        if support not in occupied:
            return []
        return [anchor for anchor, its in zip(self._now.anchors(), on, strict=True) if its == support]

    @cached_property
    def _rests_on(self) -> tuple[frozenset[str | None], tuple[str | None, ...]]:
        """The set of supports in use, and the support of each anchor; the set answers most questions at once."""
        on = tuple(map(self._now.belief.support, self._now.anchors()))
        return frozenset(on), on

    def room(self, thing: Term, support: Term) -> Term | list[Term]:
        """1 if there is room for an object on a support, perhaps after others are taken away, else 0.

        Empty for an object that is not met yet or that no hand can hold.
        """
        if support not in self._known or self.graspable(thing) != 1:
            return []
        return int(self._now.has_room(str(thing), str(support)))

    def distance(self, anchor: str) -> Term:
        """The distance from the base to the anchor, millimetres."""
        mean = self._now.belief.gaussian("pose", anchor).mean
        return round(1000 * math.hypot(float(mean[0]), float(mean[1])))

    def yaw_observable(self, anchor: str) -> Term:
        """1 if a look measures the object's yaw, else 0, as for a cylinder."""
        sd = math.sqrt(float(self._now.belief.observation_covariance("pose", anchor)[2, 2]))
        return int(sd < math.pi / 4)

    def _set_of(self, expression: str, props: Compound) -> tuple[str, ...]:
        """Return the largest sufficient set of properties that contains `props`."""
        return max((words for words in self._alternatives[expression] if set(props.args) <= set(words)), key=len)

    def _is_plausible(self, name: str, cost: int) -> bool:
        """Return whether an object is plausible enough as what is meant, or a region as the place of it."""
        if cost > nll(self._limits.min_plausible):
            self.left_out.add(name)
            return False
        return True

    def _favourable(self, word: str, anchor: str, p: int) -> float:
        return self._now.belief.prob_favourable(anchor, self._now.meanings[word], prob(p))

    def _den(self, expression: str, anchor: str) -> float:
        return self._now.probability(Compound("den", (expression, anchor)))


def load_rules(extra: Sequence[Path] = (), folder: Path | None = None) -> Rulebook:
    """Return the rules that ship with the product, with those of the user and with `Queries` as @functions.

    Args:
        extra: A user's own rule files.
        folder: A folder with the rule files to use instead of those that ship; None for those.

    Raises:
        InputError: With every fault in every file.
    """
    return Rulebook.load(Queries, extra, folder)
