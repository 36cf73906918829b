"""The `skolem` command: parse, compose, print, return an exit code."""

__all__ = ()
