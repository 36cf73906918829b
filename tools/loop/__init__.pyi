from . import worlds as worlds
from .mind import Mind as Mind
from .session import Outcome as Outcome, Watcher as Watcher, run as run
from .setup import prepare as prepare
from .verdict import verdict as verdict
from .worlds import World as World, WorldKind as WorldKind, WorldStart as WorldStart
