"""The loop observe, update, decide, act: `Mind`, `World`, the inputs of a run, and the verdict.

May import: reasoner.lint, sim.families, sim.robot, sim.scenario, traces.file.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
