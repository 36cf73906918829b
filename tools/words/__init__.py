"""Beliefs, plans and runs as text for people. May import: recorded."""

__all__ = ()
