"""The belief: a joint Gaussian over base and objects, and each object's existence, type, colour and weight.

May import: nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
