"""The belief: a joint Gaussian over base and objects, and what is known of each object's type, colour and weight.

May import: nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
