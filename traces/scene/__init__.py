"""A trace as a recording for rerun: bodies, beliefs, plans and plots. May import: file."""

__all__ = ()
