"""The verb `view`: a run in rerun. May import: loop, words, sim.physics, traces.scene."""

__all__ = ()
