"""The queries of `witness.lp`: which object may be the witness of a relation, and how sure the robot must be of it."""

from typing import Final

from skolem.reasoner.meaning.universe import Universe
from skolem.reasoner.planning.patterns import mentions
from skolem.reasoner.planning.sharing import evenly
from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.terms import Compound, Term, compound, nll
from skolem.traces.messages import Limits

MOST_WITNESSES: Final = 5  # that are tried for one object, likeliest first
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

    def _parts(self, expression: str, anchor: str, witness: Term) -> list[Compound]:
        found = self._universe.witnessed[expression]
        pair = (witness, anchor) if found.from_witness else (anchor, witness)
        described = ((found.itself, anchor), (found.witness, witness))
        parts = [Compound("den", (constant, thing)) for constant, thing in described if constant is not None]
        return [*parts, Compound("related", (found.relation, *pair))]
