"""The number of examples of a property test. Tests draw the same ones in every run; `make laws` draws fresh ones."""

from hypothesis import settings

USUAL = 100  # number of examples of a property test without settings


def examples(count: int) -> settings:
    """Return settings for `count` examples, times the ratio of the profile's number to `USUAL`.

    An expensive test asks for fewer than the usual number, a thorough one for more. With a number in `settings` itself,
    a test would draw as many under every profile.
    """
    return settings(max_examples=max(1, count * settings().max_examples // USUAL))
