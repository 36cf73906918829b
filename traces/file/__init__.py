"""One MCAP file: written, read, followed while it grows, checked, recovered. May import: nothing."""

__all__ = ()
