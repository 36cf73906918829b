"""From a goal and a belief to the next action: denotation, belief regression, the plan stack."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
