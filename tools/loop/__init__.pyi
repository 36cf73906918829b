from .mind import Mind as Mind
from .session import Outcome as Outcome, Watcher as Watcher, World as World, run as run
from .setup import prepare as prepare
from .verdict import verdict as verdict
