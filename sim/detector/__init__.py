"""From a depth picture to detections. May import: space, truth."""

__all__ = ()
