"""The verbs `replay` and `reproduce`. May import: loop, recorded, words."""

__all__ = ()
