"""The verbs `show` and `info`. May import: recorded, words."""

__all__ = ()
