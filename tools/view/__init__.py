"""The verb `view`: a run in rerun. May import: loop, sim.physics, traces.scene."""

__all__ = ()
