"""How many examples a property test draws, in the tests (the same in every run) and in `make fuzz` (fresh ones)."""

from hypothesis import settings

USUAL = 100  # examples of a property test that asks for no number of its own


def examples(count: int) -> settings:
    """Return settings for `count` examples, or for as large a share of them as the profile draws of the usual number.

    An expensive test asks for fewer than the usual number; a thorough one for more. A number given to `settings` itself
    would stay the same under every profile.
    """
    return settings(max_examples=max(1, count * settings().max_examples // USUAL))
