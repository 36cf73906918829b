"""One trace as an MCAP file: writing, reading, following while it grows, checking, recovering. May import: nothing."""

__all__ = ()
