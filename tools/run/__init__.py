"""The verb `run`. May import: loop, recorded, words."""

__all__ = ()
