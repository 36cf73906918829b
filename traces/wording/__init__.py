"""Recorded terms put into words, for whoever prints or draws a run. May import: file."""

__all__ = ()
