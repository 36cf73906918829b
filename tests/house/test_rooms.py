"""The rooms of the house: the page that lists them, no circles, nothing private, nobody who peeks, none too large."""

import ast
import re
from collections.abc import Mapping
from dataclasses import replace

import pytest
from kit.imports import House, circles, private_names
from kit.places import ROOT

HOUSE = House.at(ROOT)
MOST_FILES = 25  # in a room, `__init__.py` not counted
MOST_LINES = 400  # in a file
NEVER_SEEN = (
    "sim/truth",
    "sim/physics",
    "sim/detector",
    "sim/scenario",
    "sim/families",
)  # by whoever thinks for the robot
WHERE = "docs/how-it-works.md"
PAGE = (ROOT / WHERE).read_text(encoding="utf-8").partition("\n## Rooms\n")[2]
LINE = re.compile(r"^\| `([\w/]+?)(/|\.py)` \| [^|]+ \| ([^|]+) \|$", re.M)  # room, what it is, what it may import
FACES = {f"skolem.{folder}" for folder in ("reasoner", "estimation", "sim", "traces")}
FOR_ALL = {
    "traces/messages",
    "traces/errors.py",
    "traces/given.py",
    "traces/written.py",
    "reasoner/terms.py",
}  # a floor may still be forbidden them
TRUE_WORLDS = {"skolem.sim.symbolic.world"}  # what in the rooms of thinkers is world


def lines_of(page: str) -> dict[str, tuple[str, ...]]:
    """Return for every room of a page the rooms that its line names, each by its path."""
    found = {}
    for room, kind, names in LINE.findall(page):
        folder = room.split("/")[0]
        paths = [name.replace(".", "/") if "." in name else f"{folder}/{name}" for name in names.split(", ")]
        found[room + kind.rstrip("/")] = () if names == "nothing" else tuple(paths)
    return {room: tuple(_as_listed(path, found) for path in paths) for room, paths in found.items()}


def _as_listed(path: str, rooms: Mapping[str, object]) -> str:
    """Return the room of a page that a path means: a folder, a file, or a folder without rooms."""
    return next((p for p in (path, f"{path}.py", path.rsplit("/", 1)[-1]) if p in rooms), path)


def place_of(house: House, module: str, lines: Mapping[str, object]) -> str:
    """Return the line of the page that a module falls under: one of its own, or that of its room."""
    path = str(house.files[module].path)
    return path if path in lines else house.room_of(module)


def allowed(room: str, lines: Mapping[str, tuple[str, ...]]) -> set[str]:
    """Return all that a room may import: what its line names, and whatever that may import."""
    found: list[str] = [room]
    for name in found:  # grows while it is gone through
        found += [other for other in lines.get(name, ()) if other not in found]
    return {*found, *FOR_ALL}


def trespasses(house: House, lines: Mapping[str, tuple[str, ...]]) -> list[str]:
    """Return the imports that no line allows; a folder's face is open to `tools`."""
    found = []
    for one in house.imports:
        if house.files[one.importer].is_package or (house.files[one.meant].is_package and not one.name):
            continue  # faces are tables of names, and the name of a package alone is a way to its modules
        room, other = place_of(house, one.importer, lines), place_of(house, one.meant, lines)
        by_face = room.startswith("tools/") and one.written in FACES
        if not by_face and other not in allowed(room, lines):
            found.append(
                f"{house.files[one.importer].path} imports {one.meant}, but {WHERE} does not let {room} into {other}"
            )
    return found


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


def test_the_page_has_a_line_for_every_room() -> None:
    of_their_own = {str(HOUSE.files[module].path) for module in TRUE_WORLDS}
    assert sorted(lines_of(PAGE)) == sorted({*HOUSE.rooms} | of_their_own)


def test_lines_name_rooms_that_have_lines() -> None:
    lines = lines_of(PAGE)
    assert not {name for names in lines.values() for name in names} - set(lines)


def test_rooms_import_only_what_their_lines_say() -> None:
    assert trespasses(HOUSE, lines_of(PAGE)) == []


def test_what_a_face_offers_verbs_take_from_it() -> None:
    offered = {(meant, name) for face in FACES for name, meant in HOUSE.faces[face].items()}
    taken = [one for one in HOUSE.imports if one.importer.startswith("skolem.tools") and one.written not in FACES]
    past = [one for one in taken if (one.written, one.name) in offered and HOUSE.room_of(one.meant) not in FOR_ALL]
    assert not [f"{one.importer}: {one.name} of {one.written}" for one in past]


def test_lines_name_nothing_that_is_not_imported() -> None:
    lines = lines_of(PAGE)
    used = {
        (place_of(HOUSE, m, lines), place_of(HOUSE, o, lines)) for m, others in HOUSE.arrows.items() for o in others
    }
    assert not [f"{room}: {name}" for room, names in lines.items() for name in names if (room, name) not in used]


@pytest.mark.parametrize("room", sorted(lines_of(PAGE)))
def test_a_room_says_in_its_first_lines_what_the_page_says(room: str) -> None:
    (line,) = (names for name, kind, names in LINE.findall(PAGE) if name + kind.rstrip("/") == room)
    path = ROOT / room if room.endswith(".py") else ROOT / room / "__init__.py"
    said = " ".join((ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").split())
    assert f"May import: {line}." in said


def test_a_verb_imports_no_other_verb() -> None:
    lines = lines_of(PAGE)
    verbs = set(lines["tools/cli.py"])
    assert len(verbs) > 1
    assert not {(verb, name) for verb in verbs for name in lines[verb] if name in verbs}


def test_no_files_import_one_another_in_a_circle() -> None:
    assert not circles(HOUSE.arrows)


def test_no_rooms_import_one_another_in_a_circle() -> None:
    assert not circles(HOUSE.room_arrows)


def test_no_private_name_of_another_module_is_taken() -> None:
    taken = {str(file.path): private_names(file.text) for file in HOUSE.files.values()}
    assert not {path: names for path, names in taken.items() if names}


def test_nobody_peeks_inside_sim() -> None:
    assert not peeks(HOUSE)


def test_rooms_and_files_are_small_enough_to_be_looked_over() -> None:
    assert not too_large(HOUSE)


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("skolem.sim.planner.sight", "from skolem.sim.symbolic.arm import hands"),
        ("skolem.sim.symbolic.arm", "from skolem.sim.detector.cloud import points"),
        ("skolem.traces.file.codec", "def late():\n    from skolem.traces.compare import diff"),
        ("skolem.reasoner.language.cursor", "if TYPE_CHECKING:\n    from skolem.reasoner.agent import Agent"),
        ("skolem.tools.explain.text", "from skolem.tools.replay.replayer import Replayer"),
        ("skolem.tools.show.info", "from skolem.traces.scene.rows import STEP"),
        ("skolem.tools.words.new", "LATER = 'skolem.tools.recorded.run'"),
    ],
)
def test_a_planted_trespass_is_found(module: str, line: str) -> None:
    lines = lines_of(PAGE)
    assert len(trespasses(HOUSE.planted(module, line), lines)) == len(trespasses(HOUSE, lines)) + 1


def test_what_a_named_room_may_import_may_be_imported_too() -> None:
    house = HOUSE.planted("skolem.sim.physics.new", "from skolem.sim.space.doubt import doubt")
    assert trespasses(house, lines_of(PAGE)) == trespasses(HOUSE, lines_of(PAGE))


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
