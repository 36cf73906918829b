"""The verbs `rules` and `scenario`. May import: loop, words."""

__all__ = ()
