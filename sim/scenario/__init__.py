"""Scenario files: read, checked, and turned into a true world and a prior. May import: space, truth."""

__all__ = ()
