"""The verbs `show` and `info`. May import: loop, recorded, words."""

__all__ = ()
