"""Which of several names is the likeliest: one rule for whoever believes, simulates, prints or draws."""

from collections.abc import Mapping


def likeliest(shares: Mapping[str, float]) -> str:
    """Return the name with the highest share, of equal ones the first by alphabet.

    Args:
        shares: Probabilities or log-likelihoods, by name.

    Raises:
        ValueError: If there are none.
    """
    return max(sorted(shares), key=shares.__getitem__)
