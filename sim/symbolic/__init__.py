"""The world without physics, and the geometry that matches it.

May import: robot, space.
"""

__all__ = ()
