"""A recorded run as a replay reads it, and the mind that thinks it again. May import: loop."""

__all__ = ()
