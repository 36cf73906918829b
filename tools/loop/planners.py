"""What answers geometric questions in each world, from the belief alone; loaded when it is needed."""

from collections.abc import Mapping
from typing import Literal, Protocol

from skolem.reasoner import Geometry
from skolem.traces.messages import ObjectType

WorldKind = Literal["pybullet", "symbolic"]


class Planner(Geometry, Protocol):
    """A geometry that holds something, such as a physics client, until it is closed."""

    def close(self) -> None:
        """Free what it holds."""
        ...


def planner_of(world: WorldKind, types: Mapping[str, ObjectType], seed: int) -> Planner:
    """Return what answers the reasoner's geometric questions in one kind of world.

    Args:
        world: Which simulator the run is in.
        types: Shape and size of every type a belief may name.
        seed: The run's seed.
    """
    if world == "symbolic":
        from skolem.sim import SymbolicGeometry

        return SymbolicGeometry(types)
    from skolem.sim import PlanningWorld

    return PlanningWorld(types, seed)
