"""The world with physics: PyBullet, rendering, motors and hands. May import: robot, detector, truth."""

__all__ = ()
