"""The verb `view`: a run in rerun. May import: loop, traces.scene."""

__all__ = ()
