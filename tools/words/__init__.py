"""Beliefs, plans and runs as text for people. May import: loop."""

__all__ = ()
