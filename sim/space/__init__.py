"""What worlds and planners both reckon with: footprints, grasps, views, doubts. May import: nothing."""

__all__ = ()
