"""The rooms of the house: no circles, nothing private taken, nobody who peeks, and no room too large."""

from dataclasses import replace

import pytest
from kit.imports import House, circles, private_names
from kit.places import ROOT

HOUSE = House.at(ROOT)
MOST_FILES = 25  # in a room, `__init__.py` not counted
MOST_LINES = 400  # in a file
NEVER_SEEN = ("sim/truth", "sim/physics", "sim/detector", "sim/scenario")  # by whoever thinks for the robot
UNTIED_SOON = [tuple(f"skolem.tools.replay.{n}" for n in ("pool", "replayer", "reports", "what_if_reports"))]
LONG_STILL = ["tools/loop/session.py"]
TRUE_WORLDS = {"skolem.sim.symbolic.world"}  # what in the rooms of thinkers is world


def peeks(house: House) -> list[str]:
    """Return the ways of imports from the robot's geometry to what worlds alone may know."""
    thinkers = [*house.rooms["sim/planner"], *house.rooms["sim/symbolic"]]
    ways = house.reachable(module for module in thinkers if module not in TRUE_WORLDS)
    hidden = {module for module in house.files if house.room_of(module) in NEVER_SEEN} | TRUE_WORLDS
    return [" -> ".join(way) for module, way in sorted(ways.items()) if module in hidden]


def too_large(house: House) -> list[str]:
    """Return the rooms with too many files, and the files with too many lines, each with the number."""
    full = [f"{room}: {len(files)} files" for room, files in house.rooms.items() if len(files) > MOST_FILES]
    lines = {file.path.as_posix(): file.text.count("\n") for file in house.files.values()}
    return full + [f"{path}: {number} lines" for path, number in sorted(lines.items()) if number > MOST_LINES]


def test_no_files_import_one_another_in_a_circle() -> None:
    assert circles(HOUSE.arrows) in ([], UNTIED_SOON)


def test_no_rooms_import_one_another_in_a_circle() -> None:
    assert not circles(HOUSE.room_arrows)


def test_no_private_name_of_another_module_is_taken() -> None:
    taken = {str(file.path): private_names(file.text) for file in HOUSE.files.values()}
    assert not {path: names for path, names in taken.items() if names}


def test_nobody_peeks_inside_sim() -> None:
    assert not peeks(HOUSE)


def test_rooms_and_files_are_small_enough_to_be_looked_over() -> None:
    assert [line for line in too_large(HOUSE) if line.split(":")[0] not in LONG_STILL] == []


@pytest.mark.parametrize(
    "line",
    [
        "from skolem.tools.loop.mind import Mind",
        "import skolem.tools.loop.mind",
        "def late():\n    from skolem.tools.loop import mind",
        "if TYPE_CHECKING:\n    from skolem.tools.loop.mind import Mind",
        "LATER = 'skolem.tools.loop.mind'",
        "LATER = 'skolem.tools.loop.mind:Mind'",
    ],
)
def test_a_planted_circle_is_found(line: str) -> None:
    planted = HOUSE.planted("skolem.tools.loop.stopwatch", line)
    assert {"skolem.tools.loop.mind", "skolem.tools.loop.stopwatch"} <= {m for c in circles(planted.arrows) for m in c}


def test_a_planted_circle_of_rooms_is_found_where_no_files_are_in_one() -> None:
    planted = HOUSE.planted("skolem.sim.space.new", "from skolem.sim.planner import sight")
    assert ("sim/planner", "sim/space") in circles(planted.room_arrows)
    assert circles(planted.arrows) == circles(HOUSE.arrows)


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("skolem.sim.planner.planner", "from skolem.sim.truth.noise import Draws"),
        ("skolem.sim.planner.sight", "def late():\n    import skolem.sim.physics.world"),
        ("skolem.sim.symbolic.geometry", "from skolem.sim.symbolic.world import SymbolicWorld"),
        ("skolem.sim.symbolic.new", "from skolem.sim.detector import cloud"),
        ("skolem.sim.space.doubt", "if TYPE_CHECKING:\n    from skolem.sim.scenario.models import Scenario"),
        ("skolem.sim.robot.pr2", "from skolem.sim.truth import bodies"),
        ("skolem.sim.planner.new", "LATER = 'skolem.sim.truth.bodies'"),
    ],
)
def test_a_planted_peek_is_found(module: str, line: str) -> None:
    assert peeks(HOUSE.planted(module, line))


def test_a_peek_through_a_face_is_found() -> None:
    face = replace(HOUSE.files["skolem.sim"], face="from .truth.noise import Draws as Draws")
    house = House({**HOUSE.files, "skolem.sim": face})
    assert not peeks(house)
    assert peeks(house.planted("skolem.sim.planner.sight", "from skolem.sim import Draws"))
    assert peeks(house.planted("skolem.sim.planner.sight", "from skolem import sim"))


@pytest.mark.parametrize(
    "text",
    [
        "from skolem.sim.planner.motion import _plan",
        "def late():\n    from skolem.sim.planner.motion import _plan as plan",
        "from skolem.sim.planner import motion\nmotion._plan()",
        "import skolem.sim.planner.motion\nskolem.sim.planner.motion._plan()",
    ],
)
def test_a_planted_private_name_is_found(text: str) -> None:
    assert len(private_names(text)) == 1


def test_what_is_too_large_is_found() -> None:
    planted = HOUSE.planted("skolem.sim.truth.long", "\n" * MOST_LINES)
    for number in range(MOST_FILES):
        planted = planted.planted(f"skolem.sim.truth.n{number}", "")
    assert {"sim/truth/long.py", "sim/truth"} <= {line.split(":")[0] for line in too_large(planted)}
