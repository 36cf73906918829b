"""Recorded terms in words, for printing and drawing a run. May import: file."""

__all__ = ()
