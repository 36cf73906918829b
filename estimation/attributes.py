"""Beliefs on an object's existence and type, by Bayes' rule.

A type belief is a frozen value, like the beliefs on colour and weight. `updated` takes in one observation. `prob` gives
the probability of a property. `prob_favourable` gives the probability that one more observation raises the belief in
a property to at least p, given that the object has the property.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from skolem.traces.messages.likeliest import likeliest

ROUNDING = 1e-9  # a belief at most this far below a threshold counts as reaching it


def after_miss(existence: float, p_reported: float) -> float:
    """Return P(exists) after a look without a detection of the object; `p_reported` is P(detected | it exists)."""
    absent = 1.0 - existence
    seen_over = existence * (1.0 - p_reported)
    return seen_over / (seen_over + absent) if absent > 0.0 else 1.0


def after_evidence(existence: float, odds: float) -> float:
    """Return P(exists) after an observation that is `odds` times likelier with the object than without it."""
    return existence * odds / (existence * odds + 1.0 - existence)


@dataclass(frozen=True, slots=True)
class TypeBelief:
    """A categorical distribution over types.

    Attributes:
        probabilities: Probability of each type; they sum to 1.
        readings: Types that the detector may confuse, sorted.
        right: P(the detected type is the true one).
    """

    probabilities: dict[str, float]
    readings: tuple[str, ...]
    right: float

    def likelihood(self, true: str, reported: str) -> float:
        """Return P(reported | true): `right` for the true type, and equal shares of the rest for the other readings.

        A type outside `readings` is never confused with another.
        """
        if true not in self.readings or reported not in self.readings:
            return float(true == reported)
        if true == reported:
            return self.right
        return (1.0 - self.right) / max(1, len(self.readings) - 1)

    def updated(self, log_likelihood: dict[str, float]) -> "TypeBelief":
        """Return the belief after a detection, given the log-likelihood of its cluster under each possible type."""
        reported = _softmax(log_likelihood)
        return self._times({t: sum(w * self.likelihood(t, r) for r, w in reported.items()) for t in self.probabilities})

    def fused(self, other: "TypeBelief", prior: "TypeBelief") -> "TypeBelief":
        """Return the belief that joins the observations of both; `prior` is the belief that both began with."""
        return self._times({t: other.prob(t) / p if (p := prior.prob(t)) > 0.0 else 0.0 for t in self.probabilities})

    def evidence(self, log_likelihood: dict[str, float]) -> float:
        """Return P(a detection), the normaliser of `updated`."""
        reported = _softmax(log_likelihood)
        return sum(p * w * self.likelihood(t, r) for t, p in self.probabilities.items() for r, w in reported.items())

    def prob(self, kind: str) -> float:
        """Return P(the object is of the type)."""
        return self.probabilities.get(kind, 0.0)

    def most_likely(self) -> str:
        """Return the most probable type, the first by name among equals."""
        return likeliest(self.probabilities)

    def prob_favourable(self, kind: str, p: float, other: bool = False) -> float:
        """Return P(one look raises the belief in `kind` to at least `p` | the object is of that type).

        With `other`, the belief and the condition are that the object is of another type than `kind`.
        """
        rest = {t: q for t, q in self.probabilities.items() if t != kind}
        if not other:
            return self._reached({kind: 1.0}, lambda after: after.prob(kind) >= p - ROUNDING)
        total = sum(rest.values())
        likely = {t: q / total for t, q in rest.items()} if total > 0.0 else {}
        return self._reached(likely, lambda after: 1.0 - after.prob(kind) >= p - ROUNDING)

    def _reached(self, true: Mapping[str, float], enough: "Callable[[TypeBelief], bool]") -> float:
        """Return P(the belief after one look is enough), for a distribution of the true type."""
        good = [reported for reported in self.readings if enough(self.updated({reported: 0.0}))]
        return sum(q * self.likelihood(t, reported) for reported in good for t, q in true.items())

    def _times(self, likelihood: dict[str, float]) -> "TypeBelief":
        joint = {t: p * likelihood[t] for t, p in self.probabilities.items()}
        total = sum(joint.values())
        return replace(self, probabilities={t: v / total for t, v in joint.items()}) if total > 0.0 else self


def _softmax(log_likelihood: dict[str, float]) -> dict[str, float]:
    """Return weights that sum to 1, in order of name."""
    highest = max(log_likelihood.values())
    weights = {name: math.exp(log_likelihood[name] - highest) for name in sorted(log_likelihood)}
    total = sum(weights.values())
    return {name: weight / total for name, weight in weights.items()}
