"""A recorded run as a replay reads it, and the mind that decides again. May import: loop, traces.compare."""

__all__ = ()
