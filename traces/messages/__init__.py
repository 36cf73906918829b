"""The messages between folders, as frozen models, with one file for each subject.

Every folder imports them, and they import none. The topics of a trace stand in `topics`. May import: nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
