"""The simulated world: the only holder of the truth, and the robot's motion planning in a client of its own."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
