"""Comparison of two runs, and golden runs. May import: file."""

__all__ = ()
