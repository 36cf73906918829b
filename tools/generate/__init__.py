"""The verb `generate`. May import: loop, words."""

__all__ = ()
