"""The world without physics, and the geometry that matches it.

May import: the world (`world`) detector and truth; the geometry (all other files) space and robot, never truth.
"""

__all__ = ()
