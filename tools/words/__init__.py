"""Beliefs, plans and runs as text for people. May import: loop, traces.wording."""

__all__ = ()
