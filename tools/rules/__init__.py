"""The verbs `rules` and `scenario`. May import: loop, recorded, words."""

__all__ = ()
