"""The queries of `witness.lp` and `superlative.lp`: witnesses of relations, and what tells which of two is ahead."""

import math
from typing import Final

from skolem.reasoner.meaning.universe import Universe
from skolem.reasoner.planning.patterns import mentions
from skolem.reasoner.planning.sharing import evenly
from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.terms import Compound, Term, compound, nll
from skolem.traces.messages import Limits

MOST_WITNESSES: Final = 5  # that are tried for one object, likeliest first
_PLACED: Final = 20  # sd of a place that is compared, millimetres
_APART: Final = 3.5  # deviations between two weights of which one is surely the greater (2.5, in each of both)
_IN_ONE_GO: Final = 0.5  # of the present sd of a weight
_EITHER: Final = 0.5  # P that an object not met yet is ahead of another one
_STRANGER: Final = 0.1  # P that an object not met yet stands in a relation, where nothing else is known


class Relating:
    """Answers about relations between objects, in one situation."""

    _now: Situation
    _limits: Limits
    _universe: Universe

    def witnesses(self, expression: str, anchor: Term, p: int) -> list[Term]:
        """The anchors that may be the witness for an object, likeliest first, and a Skolem constant for one not met."""
        if expression not in self._universe.witnessed or not isinstance(anchor, str):
            return []
        priced = []
        for i, other in enumerate(self._now.anchors()):
            if other != anchor:
                cost = sum(nll(self._now.probability(phi)) for phi in self._parts(expression, anchor, other))
                priced.append((cost, i, other))
        likely = [other for cost, _, other in sorted(priced) if cost <= nll(self._limits.min_plausible)]
        asked = self._universe.witnessed[expression].witness
        unmet: list[Term] = [] if asked is None else [compound("sk", compound("witness_of", expression, anchor))]
        return [*likely[:MOST_WITNESSES], *unmet]

    def asked_of(self, expression: str, anchor: str, witness: Term, p: int) -> list[Term]:
        """(phi, share of p) for all that must hold: what is said of the object and of the witness, and the relation."""
        parts = self._parts(expression, anchor, witness)
        return [Compound("", (phi, evenly(p, len(parts)))) for phi in parts]

    def related_now(self, relation: str, one: Term, other: Term) -> int:
        """-ln P(the relation holds of two objects), by what is believed now."""
        phi = Compound("related", (relation, one, other))
        return nll(_STRANGER if mentions(phi, "sk") else self._now.probability(phi))

    def compared(self, expression: str, pair: Compound) -> list[Term]:
        """(quantity, object, sd in thousandths) for all that tells which of two is ahead by a superlative.

        Each is to be known so well that the present means would be apart for sure, but in one go not much better than
        now: the means may move. What is known much better than the other need not be measured.
        """
        ranked = self._universe.ranked.get(expression)
        if ranked is None or not all(isinstance(each, str) for each in pair.args):
            return []
        things = [str(each) for each in pair.args]
        if ranked.kind == "nearest":
            return [Compound("", ("pose", each, _PLACED)) for each in (*things, str(ranked.to))]
        (mean, sd), (other_mean, other_sd) = map(self._weight, things)
        apart = abs(mean - other_mean) / _APART
        wanted = (_finer(sd, other_sd, apart), _finer(other_sd, sd, apart))
        return [Compound("", ("weight", each, math.ceil(1000 * v))) for each, v in zip(things, wanted, strict=True)]

    def _weight(self, anchor: str) -> tuple[float, float]:
        known = self._now.belief.gaussian("weight", anchor)
        return float(known.mean[0]), math.sqrt(float(known.covariance[0, 0]))

    def beats_now(self, expression: str, rival: Term, anchor: Term) -> int:
        """-ln P(an object is ahead of a rival, or that does not fit), by what is believed now."""
        phi = Compound("beaten", (expression, rival, anchor))
        return nll(_EITHER if mentions(phi, "sk") else self._now.probability(phi))

    def _parts(self, expression: str, anchor: str, witness: Term) -> list[Compound]:
        found = self._universe.witnessed[expression]
        pair = (witness, anchor) if found.from_witness else (anchor, witness)
        described = ((found.itself, anchor), (found.witness, witness))
        parts = [Compound("den", (constant, thing)) for constant, thing in described if constant is not None]
        return [*parts, Compound("related", (found.relation, *pair))]


def _finer(sd: float, other: float, apart: float) -> float:
    """Return the sd with which one of two weights is to be known, from both sds now and the one that would tell."""
    return sd if sd <= _IN_ONE_GO * other else max(apart, _IN_ONE_GO * sd)
