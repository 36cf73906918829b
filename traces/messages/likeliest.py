"""The likeliest of several names, by one rule for estimation, simulation and display."""

from collections.abc import Mapping


def likeliest(shares: Mapping[str, float]) -> str:
    """Return the name with the highest share; among equal ones the first in the alphabet.

    Args:
        shares: Probabilities or log-likelihoods, by name.

    Raises:
        ValueError: If `shares` is empty.
    """
    return max(sorted(shares), key=shares.__getitem__)
