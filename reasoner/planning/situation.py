"""The truth of fluents now: here alone, terms of the rules meet the belief and the geometry.

A `Situation` is one version of the belief; every answer is kept for as long as that version lasts.
"""

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Final, Protocol

import numpy as np

from skolem.reasoner.planning import gaussians
from skolem.reasoner.planning.patterns import mentions
from skolem.reasoner.protocols import BeliefQueries, Geometry
from skolem.reasoner.terms import ANY, Compound, Term, compound, nll, prob
from skolem.traces.errors import InternalError, RuleError
from skolem.traces.messages import HANDS, SENSING_HAND, Activity, Hand, Meaning, Quantity

_CERTAIN: Final = 1e-12  # a variance below this counts as this
_ACTIVITIES = "look/1, look_region/1, pick/2, place/3 and weigh/1"
QUANTITIES: tuple[Quantity, ...] = ("pose", "colour", "weight")
Denotation = Callable[[str, str], float]  # (expression constant, anchor) -> P(Den)
Stranger = Callable[[str, str], float]  # (expression constant, region) -> P(an arbitrary object there is denoted)
World = Callable[[Term, float | None], "Bounds"]  # (phi, the probability that decides) -> bounds of P(phi)


class Bounds(Protocol):
    """The bounds between which a probability lies."""

    @property
    def low(self) -> float:
        """The least that it can be."""
        ...

    @property
    def high(self) -> float:
        """The most that it can be."""
        ...


class Situation:
    """Truth and probability of fluents in one belief.

    Attributes:
        belief: The belief.
        meanings: What the words mean.
        fruitless_here: Commands that failed from where the robot stands and are not to be repeated from here.
    """

    def __init__(
        self,
        belief: BeliefQueries,
        geometry: Geometry | None,
        denotation: Denotation,
        stranger: Stranger,
        meanings: Mapping[str, Meaning],
        fruitless_here: Collection[Term] = (),
        world: World | None = None,
    ) -> None:
        self.belief = belief
        self._world = world
        self._geometry = geometry
        self.meanings = meanings
        self._denotation = denotation
        self.fruitless_here = fruitless_here
        self._stranger = stranger
        self._anchors = belief.anchors()
        self._holds: dict[Term, bool] = {}
        self._probability: dict[Term, float] = {}

    def holds(self, fluent: Term) -> bool:
        """Return whether a ground fluent is true now; nothing is true of a Skolem constant but that it is another one.

        Raises:
            RuleError: If the fluent is of a kind no rule may use.
        """
        if fluent not in self._holds:
            try:
                known = not mentions(fluent, "sk") or _functor(fluent) == "differ"
                self._holds[fluent] = known and self._evaluate(fluent)
            except (ArithmeticError, LookupError, TypeError, ValueError) as error:
                text = f"the rules ask for {fluent}, which cannot be evaluated: {type(error).__name__}: {error}"
                raise RuleError(text, _functor(fluent)) from error
        return self._holds[fluent]

    def probability(self, phi: Term) -> float:
        """Return P(phi) for the phi of a fluent `b(phi, p)`."""
        if phi not in self._probability:
            self._probability[phi] = self._probability_of(phi)
        return self._probability[phi]

    @property
    def geometry(self) -> Geometry:
        """The source of answers to geometric questions.

        Raises:
            InternalError: If there is none: a goal was only to be evaluated.
        """
        if self._geometry is None:
            raise InternalError("a geometric fluent was asked for where there is no geometry")
        return self._geometry

    def anchors(self) -> tuple[str, ...]:
        """Return the universe: every anchor believed to exist, in order of introduction."""
        return self._anchors

    def _evaluate(self, fluent: Term) -> bool:
        match fluent:
            case Compound("b", (Compound("den" | "together" | "holds_of_the_world") as phi, int(p))) if self._world:
                return nll(self._world(phi, prob(p)).low) <= p
            case Compound("b", (phi, int(p))):
                return nll(self.probability(phi)) <= p
            case Compound("bn", (Compound(quantity, (str(anchor),)), mu, sigma, delta, p)):
                return self._gaussian_holds(quantity, anchor, mu, sigma, delta, p)
            case Compound("krd", (anchor,)):
                return anchor in self._anchors
            case Compound("differ", (one, other)):
                return one != other
            case Compound("holding", (str(anchor),)):
                return self.hand_of(anchor) is not None
            case Compound("loose", (str(anchor),)):
                return self.hand_of(anchor) is None
            case Compound("held", (str(hand), str(anchor))):
                return self.belief.held(hand_named(hand)) == anchor
            case Compound("empty", (str(hand),)):
                return self.belief.held(hand_named(hand)) is None
            case Compound("at", (activity,)):
                wanted = self.activity(activity)
                return wanted is not None and self.geometry.ready(wanted) is not None
            case Compound("clear", (activity,)):
                return not self.blockers(activity)
            case Compound("aside", (str(anchor), activity)):
                return self.hand_of(anchor) is None and anchor not in self.blockers(activity)
        text = f"the rules ask for {fluent}, which is not a fluent the belief or the geometry can answer"
        raise RuleError(text, _functor(fluent))

    def degree(self, fluent: Term) -> float:
        """Return how near a false fluent is to being true; only the growth between two moments says something.

        Of a belief that is its probability, of a Gaussian one the mean of -ln sd over the axes that Sigma bounds, with
        no sd taken as less than its bound; of any other 0. A pose counts as 0, too: what looks from here do not show of
        it is seen from elsewhere.
        """
        match fluent:
            case Compound("b", (phi, _)):
                return self.probability(phi)
            case Compound("bn", (Compound(quantity, (str(anchor),)), _, sigma, *_)) if (
                quantity != "pose" and anchor in self._anchors
            ):
                variances = np.diag(self.belief.gaussian(quantity_named(quantity), anchor).covariance)
                bounded = [max(variances[axis], bound**2, _CERTAIN) for axis, bound in gaussians.axes_of(sigma)]
                return float(-0.5 * np.mean(np.log(bounded))) if bounded else 0.0
        return 0.0

    def _gaussian_holds(self, quantity: str, anchor: str, mu: Term, sigma: Term, delta: Term, p: Term) -> bool:
        if anchor not in self._anchors:
            return False
        if quantity == "pose" and mu == ANY and self.hand_of(anchor) is not None:
            return True
        known = quantity_named(quantity)
        return gaussians.holds(known, self.belief.gaussian(known, anchor), mu, sigma, delta, p)

    def _probability_of(self, phi: Term) -> float:
        match phi:
            case Compound("den", (str(expression), str(anchor))):
                return self._denotation(expression, anchor)
            case Compound("exists", (str(anchor),)):
                return self.belief.prob_exists(anchor)
            case Compound("on", (str(anchor), str(support))):
                return self.belief.prob_exists(anchor) * self.belief.prob_on(anchor, support)
            case Compound("off", (str(anchor), str(support))):
                return 1.0 - self.belief.prob_exists(anchor) * self.belief.prob_on(anchor, support)
            case Compound("unlike", (str(expression), str(anchor))):
                if self._world is None:
                    return 1.0 - self._denotation(expression, anchor)
                return 1.0 - self._world(Compound("den", (expression, anchor)), None).high
            case Compound("none_in", (str(expression), str(region))):
                return 1.0 - self.belief.prob_exists_in(region, self._stranger(expression, region))
            case Compound("beaten") if self._world is not None:
                return self._world(phi, None).low
            case Compound("related", (str(relation), one, other)) if self._world is not None:
                return self._world(Compound(relation, (one, other)), None).low
            case Compound("holds_of_the_world" | "together") if self._world is not None:
                return self._world(phi, None).low
            case Compound("contents", (str(region),)):
                return self.belief.prob_contents(region)
            case Compound("exists_in", (str(expression), str(region))):
                return self.belief.prob_exists_in(region, self._stranger(expression, region))
            case Compound("prop" | "supposed", (str(word), str(anchor))):
                return self._prob_all((word,), anchor)
            case Compound("type", (str(anchor), str(word))):
                return self._prob_all((word,), anchor)
            case Compound("holds", (Compound("", words), str(anchor))):
                return self._prob_all(map(str, words), anchor)
        raise RuleError(f"the rules ask for the probability of {phi}, which the belief cannot answer", _functor(phi))

    def _prob_all(self, words: Iterable[str], anchor: str) -> float:
        """Return P(the object has each of some properties), given that it exists; 0 if that is not believed."""
        if anchor not in self._anchors:
            return 0.0
        return math.prod(self.prob_word(word, anchor) for word in words)

    def prob_word(self, word: str, anchor: str) -> float:
        """Return P(the object has the property), given that it exists.

        Raises:
            RuleError: If the vocabulary has no such word.
        """
        if word not in self.meanings:
            raise RuleError(f"no property {word!r}; there are: {', '.join(sorted(self.meanings))}", word)
        return self.belief.prob_property(anchor, self.meanings[word])

    def blockers(self, activity: Term) -> tuple[str, ...]:
        """Return the anchors that block an activity.

        There are none of a look or a pick while its object is in a hand, and none if there is no room for a place
        whatever is taken away.
        """
        match activity:
            case Compound("place", (str(anchor), str(support), _)):
                return self._taking_room(anchor, support) or ()
        wanted = self.activity(activity)
        if wanted is None or self.hand_of(wanted.anchor) is not None:
            return ()
        return self.geometry.blockers(wanted) or ()

    def has_room(self, anchor: str, support: str) -> bool:
        """Return whether there is room for an object on a support, perhaps after others were taken away."""
        return self._taking_room(anchor, support) is not None

    def _taking_room(self, anchor: str, support: str) -> tuple[str, ...] | None:
        return self.geometry.blockers(Activity("place", anchor, self.hand_of(anchor), support))

    def hand_of(self, anchor: str) -> Hand | None:
        """Return the hand that holds the anchor."""
        return next((hand for hand in HANDS if self.belief.held(hand) == anchor), None)

    def objection(self, executes: Term) -> tuple[Term, str] | None:
        """Return the missing fluent that makes a command impossible now, with a message; None if none is missing."""
        match executes:
            case Compound("weigh", (str(anchor),)) if self.hand_of(anchor) not in (None, SENSING_HAND):
                lacking = compound("held", SENSING_HAND, anchor)
                return lacking, (
                    f"{executes} was asked for with {anchor} in the {self.hand_of(anchor)} hand, but only the "
                    f"{SENSING_HAND} wrist has a force-torque sensor: a rule that executes weigh(O) must demand "
                    f"held({SENSING_HAND}, O)"
                )
        return None

    def activity(self, term: Term) -> Activity | None:
        """Return the activity of a term such as `pick(right, o)`; None if it is impossible with the present hands.

        Raises:
            RuleError: If there is no such activity.
        """
        match term:
            case Compound("look", (str(anchor),)):
                elsewhere = term in self.fruitless_here
                return Activity("look", anchor, elsewhere=elsewhere) if self.hand_of(anchor) is None else None
            case Compound("pick", (str(hand), str(anchor))):
                return Activity("pick", anchor, hand_named(hand))
            case Compound("look_region", (str(region),)):
                return Activity("look_region", region)
            case Compound("place", (str(anchor), str(support), other)):
                holder = self.hand_of(anchor)
                clear_of = None if other == "nothing" else self._to_keep_clear(other)
                return None if holder is None else Activity("place", anchor, holder, support, clear_of)
            case Compound("weigh", (str(anchor),)):
                holder = self.hand_of(anchor)
                return None if holder is None else Activity("weigh", anchor, holder)
        raise RuleError(f"the rules name the activity {term}; there are {_ACTIVITIES}", _functor(term))

    def _to_keep_clear(self, term: Term) -> Activity | None:
        """Return an activity that will be done later: the object of a place need not be in a hand yet."""
        match term:
            case Compound("place", (str(anchor), str(support), _)):
                return Activity("place", anchor, self.hand_of(anchor), support)
        return self.activity(term)


def _functor(term: Term) -> str:
    return term.name if isinstance(term, Compound) else str(term)


def hand_named(name: str) -> Hand:
    """Return the hand of that name.

    Raises:
        RuleError: If there is none.
    """
    for hand in HANDS:
        if hand == name:
            return hand
    raise RuleError(f"the rules name the hand {name!r}; there are {', '.join(HANDS)}", name)


def quantity_named(name: str) -> Quantity:
    """Return the quantity of that name.

    Raises:
        RuleError: If there is none.
    """
    for quantity in QUANTITIES:
        if quantity == name:
            return quantity
    raise RuleError(f"the rules name the quantity {name!r}; there are {', '.join(QUANTITIES)}", name)
