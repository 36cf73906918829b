"""The verb `run`. May import: loop, words."""

__all__ = ()
