"""Goals and descriptions, as text and as values. May import: nothing."""

__all__ = ()
