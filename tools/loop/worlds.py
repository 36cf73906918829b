"""Worlds by name: for each kind, the builder of the true world and its motion planner.

An installed package adds a world by an entry point of the group `skolem.worlds`: the name of the entry point is the one
that `--world` takes, its value is a `WorldKind`. A script can also give its own `WorldKind` to `prepare`.
"""

import difflib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Final, Protocol

from google.protobuf.message import Message as Protobuf

from skolem.reasoner import Geometry
from skolem.traces.errors import Fault, InputError, error_text
from skolem.traces.messages import (
    Action,
    ActionResult,
    NoiseModel,
    ObjectType,
    Observation,
    Pose2,
    Pose4,
    RobotState,
    TrueState,
)

if TYPE_CHECKING:  # replays name worlds and build none: they load nothing of sim
    from skolem.sim.truth.bodies import TrueBody

GROUP: Final = "skolem.worlds"  # name of the group of entry points


class World(Protocol):
    """A simulator or robot that executes actions."""

    @property
    def tick(self) -> int:
        """Simulated time so far, in ticks."""
        ...

    def robot_state(self) -> RobotState:
        """Return the readings of the encoders."""
        ...

    def state(self, step: int) -> TrueState:
        """Return the true state."""
        ...

    def disturb(self, object_id: str, world_T_object: Pose4) -> None:
        """Move an object without the robot."""
        ...

    def execute(self, action: Action) -> tuple[ActionResult, Observation]:
        """Carry out an action; return its result and the observation after it."""
        ...

    def close(self) -> None:
        """Free the resources of the world."""
        ...


class Planner(Geometry, Protocol):
    """A geometry with resources, such as a physics client, that `close` frees."""

    def close(self) -> None:
        """Free the resources."""
        ...


@dataclass(frozen=True, slots=True)
class WorldStart:
    """The inputs from which a true world is built.

    Attributes:
        types: Shape and size of every object type, by name.
        bodies: The true bodies.
        world_T_base: True pose of the robot's base: metres, radians.
        torso_m: Height of the torso lift.
        noise: True noise of sensors and motion.
        believed_noise: The robot's noise model.
        seed: Seed of every random draw.
        images: Whether camera images are recorded.
        record: Records a protobuf message of this world, such as an image, on a topic.
    """

    types: Mapping[str, ObjectType]
    bodies: "tuple[TrueBody, ...]"
    world_T_base: Pose2
    torso_m: float
    noise: NoiseModel
    believed_noise: NoiseModel
    seed: int
    images: bool
    record: Callable[[str, Protobuf], None]


def _no_model() -> str:
    """Return the hash of a robot model that consists of no files."""
    return ""


@dataclass(frozen=True, slots=True)
class WorldKind:
    """One kind of world: the simulator or robot that a run takes place in.

    Attributes:
        name: Its name for `--world` and in traces: a letter, then letters, digits and any of `_.-`.
        build: Builds the true world; nothing else gets the truth.
        planner: Makes the planner, which answers geometric questions from the belief alone, for object types and the
            seed of the run.
        robot_sha256: Hashes the files of the robot's model; empty if it has none.
        camera: Whether the world has images to record.
    """

    name: str
    build: Callable[[WorldStart], World]
    planner: Callable[[Mapping[str, ObjectType], int], Planner]
    robot_sha256: Callable[[], str] = _no_model
    camera: bool = False


def names() -> list[str]:
    """Return the names of all installed worlds, sorted."""
    return sorted({*SHIPPED, *(entry.name for entry in entry_points(group=GROUP))})


def named(name: str, asked: str = "--world") -> WorldKind:
    """Return the world of a name; worlds that ship come first.

    Args:
        name: The name.
        asked: The flag or the trace that names the world, for the error.

    Raises:
        InputError: If no such world is installed, or it cannot be used.
    """
    if name in SHIPPED:
        return SHIPPED[name]
    entries = sorted(entry_points(group=GROUP, name=name), key=lambda entry: entry.value)
    if not entries:
        known = names()
        close = difflib.get_close_matches(name, known, 1)
        hint = f"did you mean '{close[0]}'? " if close else ""
        raise InputError([Fault(asked, 0, 0, f"no world '{name}' is installed; {hint}there are: {', '.join(known)}")])
    if len({entry.value for entry in entries}) > 1:
        offers = " and ".join(entry.value for entry in entries)
        raise InputError([Fault(asked, 0, 0, f"two packages offer a world '{name}': {offers}; uninstall one")])
    return _loaded(entries[0], asked)


def _loaded(entry: EntryPoint, asked: str) -> WorldKind:
    """Return the world of an entry point, under the entry point's name."""
    try:
        kind = entry.load()
    except Exception as error:
        said = f"the world '{entry.name}' ({entry.value}) cannot be loaded: {error_text(error)}"
        raise InputError([Fault(asked, 0, 0, said)]) from error
    if not isinstance(kind, WorldKind):
        said = f"the world '{entry.name}' ({entry.value}) is a {type(kind).__name__}, expected a WorldKind"
        raise InputError([Fault(asked, 0, 0, said)])
    return replace(kind, name=entry.name)


def _pybullet_world(start: WorldStart) -> World:
    from skolem.sim import PyBulletWorld

    return PyBulletWorld(
        dict(start.types),
        start.bodies,
        start.world_T_base,
        start.torso_m,
        start.noise,
        start.seed,
        start.record,
        start.images,
        start.believed_noise,
    )


def _pybullet_planner(types: Mapping[str, ObjectType], seed: int) -> Planner:
    from skolem.sim import PlanningWorld

    return PlanningWorld(types, seed)


def _pr2_sha256() -> str:
    from skolem.sim.robot.assets import robot_sha256

    return robot_sha256()


def _symbolic_world(start: WorldStart) -> World:
    from skolem.sim import SymbolicWorld

    return SymbolicWorld(
        start.types,
        start.bodies,
        start.world_T_base,
        start.torso_m,
        start.noise,
        start.seed,
        start.believed_noise,
    )


def _symbolic_planner(types: Mapping[str, ObjectType], seed: int) -> Planner:
    from skolem.sim import SymbolicGeometry

    return SymbolicGeometry(types)


PYBULLET: Final = WorldKind("pybullet", _pybullet_world, _pybullet_planner, _pr2_sha256, camera=True)
SYMBOLIC: Final = WorldKind("symbolic", _symbolic_world, _symbolic_planner)
SHIPPED: Final = {kind.name: kind for kind in (PYBULLET, SYMBOLIC)}
