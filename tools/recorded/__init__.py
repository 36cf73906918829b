"""A recorded run as a replay reads it, and the mind that thinks it again. May import: loop, traces.compare."""

__all__ = ()
