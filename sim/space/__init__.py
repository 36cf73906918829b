"""What worlds and planners both reckon with: footprints, grasps, views, doubts. May import: robot."""

__all__ = ()
