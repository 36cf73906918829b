"""A trace as a recording for rerun: bodies, beliefs, plans and plots. May import: file, wording."""

__all__ = ()
