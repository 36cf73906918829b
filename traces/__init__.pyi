from .compare.diff import compare as compare
from .errors import (
    Fault as Fault,
    InputError as InputError,
    InternalError as InternalError,
    SkolemError as SkolemError,
    TraceError as TraceError,
)
from .file.check import check as check
from .file.following import follow as follow
from .file.reader import Trace as Trace
from .file.writer import TraceWriter as TraceWriter
