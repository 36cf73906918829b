"""One MCAP file: written, read, followed while it grows, checked, recovered. May import: nothing but the vocabulary."""

__all__ = ()
