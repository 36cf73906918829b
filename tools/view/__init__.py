"""The verb `view`: a run in rerun. May import: loop, recorded, words."""

__all__ = ()
