"""What worlds and planners both use: footprints, grasps, the camera's geometry, doubts. May import: nothing."""

__all__ = ()
