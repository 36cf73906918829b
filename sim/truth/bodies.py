"""The true bodies with which a world starts."""

from dataclasses import dataclass

from skolem.traces.messages import Pose4


@dataclass(frozen=True, slots=True)
class TrueBody:
    """One body of the simulated world.

    Attributes:
        id: Its name in the scenario, which the robot may or may not know.
        type: Name of its object type.
        world_T_object: Pose of the centre of its base face.
        hsv: Colour, each 0..1.
        kg: Mass.
    """

    id: str
    type: str
    world_T_object: Pose4
    hsv: tuple[float, float, float]
    kg: float
