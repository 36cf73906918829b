"""The verbs about trace files: `check`, `recover`, `diff` and `trace bless`. May import: loop, recorded, words."""

__all__ = ()
