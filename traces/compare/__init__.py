"""Two runs compared, and golden runs. May import: file."""

__all__ = ()
