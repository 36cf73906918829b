"""Goals and descriptions, as text and as values. May import: terms."""

__all__ = ()
