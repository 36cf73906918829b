"""The simulated world, which alone holds the truth, and motion planning in the believed world."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
