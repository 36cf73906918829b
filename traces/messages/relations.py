"""Relations of objects, and the objects that nobody has met, as the reasoner asks about them."""

from typing import Literal

from skolem.traces.messages.base import Anchor, Message, Probability
from skolem.traces.messages.words import WeightInterval


class Relation(Message):
    """A relation of known objects whose truth depends on where they are or what they weigh.

    on: the first rests on the second. near: their middles are at most `distance_m` apart. heavier: the first weighs
    more than the second. nearer: the middle of the first is nearer to that of the third than the middle of the second
    is. weighs: the first has the weight of `meaning`. With `earlier` it is about the places of objects before the robot
    first picked them.
    """

    kind: Literal["on", "near", "heavier", "nearer", "weighs"]
    anchors: tuple[Anchor, ...]
    distance_m: float = 0.0
    meaning: WeightInterval | None = None
    earlier: bool = False


class Strangers(Message):
    """The objects of a region that nobody has met: a Poisson number of them, and perhaps one that was overlooked.

    `expected` is the mean of the number, `overlooked` P(one more was overlooked in what has been seen).
    """

    support: Anchor
    expected: float
    overlooked: Probability
