"""Geometric questions answered by motion planning in the believed world. May import: robot, space."""

__all__ = ()
