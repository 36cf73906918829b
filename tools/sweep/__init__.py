"""The verb `sweep`: many runs, and their tables. May import: loop, recorded, words."""

__all__ = ()
