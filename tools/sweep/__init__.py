"""The verb `sweep`: many runs, and their tables. May import: loop, words."""

__all__ = ()
