"""The floors of the house: who may import whom, and where no clock, global generator or hash order may be read."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from kit.places import ROOT

FOLDERS = ("rules", "reasoner", "estimation", "sim", "traces", "tools")
VOCABULARY = {"skolem.traces.messages", "skolem.traces.errors", "skolem.traces.given", "skolem.traces.written"}
SKOLEM: dict[str, set[str]] = {  # what of the product each folder may import
    "rules": set(),
    "reasoner": {"skolem.reasoner", "skolem.rules"} | VOCABULARY,
    "estimation": {"skolem.estimation"} | VOCABULARY,
    "sim": {"skolem.sim"} | VOCABULARY,
    "traces": {"skolem.traces"},
    "tools": {f"skolem.{folder}" for folder in FOLDERS},
}
NEVER: dict[str, set[str]] = {  # libraries that belong to another folder
    "rules": {"clingo", "gtsam", "pybullet", "ompl", "mcap", "numpy"},
    "reasoner": {"gtsam", "pybullet", "ompl", "mcap"},
    "estimation": {"clingo", "pybullet", "ompl", "mcap"},
    "sim": {"clingo", "gtsam", "mcap"},
    "traces": {"clingo", "gtsam", "pybullet", "ompl"},
    "tools": {"gtsam"},
}
GTSAM_MODULES = {f"estimation/{name}.py" for name in ("consolidation", "graph_state", "pose_graph")}
REPRODUCIBLE = ("reasoner", "estimation", "sim")
CLOCKS_AND_DICE = {"time", "datetime", "random", "secrets", "uuid"}
KEYED_RANDOMNESS = {"Generator", "PCG64", "SeedSequence"}


def modules(*folders: str) -> list[Path]:
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]


def named(path: Path) -> str:
    """Return a module's path below the root of the checkout."""
    return path.relative_to(ROOT).as_posix()


def imports(tree: ast.AST) -> Iterator[str]:
    """Yield the full name of every imported module or member; a relative import begins with dots."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ("." * node.level + f"{node.module or ''}.{alias.name}" for alias in node.names)


def within(name: str, packages: set[str]) -> bool:
    return any(name == package or name.startswith(package + ".") for package in packages)


def forbidden(folder: str, tree: ast.AST) -> list[str]:
    """Return the imports that a module of `folder` must not have."""
    found = sorted(set(imports(tree)))
    return [
        name
        for name in found
        if (name.split(".")[0] == "skolem" and not within(name, SKOLEM[folder]))
        or within(name, NEVER[folder])
        or name.startswith(".")
        or name.split(".")[0] in FOLDERS
    ]


def unreproducible(tree: ast.AST) -> list[str]:
    """Return the lines that read a clock, a global generator, or could order by hash or address.

    A class may compute its own hash, in `__hash__` or kept by `__init__`; dictionaries need it.
    """
    found = [f"import {name}" for name in imports(tree) if within(name, CLOCKS_AND_DICE)]
    own = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef) and n.name in ("__init__", "__hash__")]
    hashing = {call for function in own for call in ast.walk(function)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) in ("np.random", "numpy.random"):
            found += [ast.unparse(node)] if node.attr not in KEYED_RANDOMNESS else []
        elif isinstance(node, ast.ImportFrom) and node.module == "numpy.random":
            found += [ast.unparse(node)] if {a.name for a in node.names} - KEYED_RANDOMNESS else []
        elif isinstance(node, ast.Call) and ast.unparse(node.func) in ("hash", "id", "os.urandom"):
            found += [ast.unparse(node)] if node not in hashing else []
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("SeedSequence", "PCG64")):
            found += [ast.unparse(node)] if not node.args and not node.keywords else []
        elif isinstance(node, ast.keyword) and node.arg == "key" and ast.unparse(node.value) in ("hash", "id"):
            found.append(f"key={ast.unparse(node.value)}")
    return found


@pytest.mark.parametrize("path", modules(*FOLDERS), ids=named)
def test_imports_point_down(path: Path) -> None:
    assert not forbidden(named(path).split("/")[0], ast.parse(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("path", modules(*REPRODUCIBLE), ids=named)
def test_no_clock_dice_or_hash_order_decides(path: Path) -> None:
    assert not unreproducible(ast.parse(path.read_text(encoding="utf-8")))


def test_gtsam_stays_behind_the_pose_graph() -> None:
    users = {
        named(path)
        for path in modules(*FOLDERS)
        if any(within(name, {"gtsam"}) for name in imports(ast.parse(path.read_text(encoding="utf-8"))))
    }
    assert users <= GTSAM_MODULES


def test_mind_alone_composes_an_agent() -> None:
    agents = {"skolem.reasoner.Agent", "skolem.reasoner.agent.Agent"}
    users = [
        named(path) for path in modules("tools") if agents & set(imports(ast.parse(path.read_text(encoding="utf-8"))))
    ]
    assert users == ["tools/loop/mind.py"]


@pytest.mark.parametrize("path", [ROOT / "traces/errors.py", *modules("traces/messages")], ids=named)
def test_what_all_may_import_stands_on_nothing_else_of_the_product(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert not [name for name in imports(tree) if within(name, {"skolem"}) and not within(name, VOCABULARY)]


@pytest.mark.parametrize(
    ("folder", "line"),
    [
        ("reasoner", "from skolem.sim import scenario"),
        ("reasoner", "from skolem import sim"),
        ("reasoner", "import gtsam"),
        ("reasoner", "from skolem.traces.file.reader import Trace"),
        ("estimation", "import skolem.sim.truth.bodies as truth"),
        ("estimation", "from skolem.reasoner.protocols import Gaussian"),
        ("estimation", "import clingo.ast"),
        ("estimation", "def late():\n    import pybullet"),
        ("sim", "from skolem.estimation.belief import Belief"),
        ("traces", "from skolem.tools.cli import main"),
        ("traces", "if TYPE_CHECKING:\n    from skolem.reasoner import agent"),
        ("tools", "import reasoner"),
        ("sim", "from . import noise"),
    ],
)
def test_a_planted_edge_is_found(folder: str, line: str) -> None:
    assert len(forbidden(folder, ast.parse(line))) == 1


@pytest.mark.parametrize(
    "line",
    [
        "import time",
        "from time import perf_counter",
        "from datetime import datetime",
        "import random",
        "np.random.normal()",
        "np.random.default_rng(7)",
        "from numpy.random import default_rng",
        "np.random.SeedSequence()",
        "sorted(names, key=hash)",
        "sorted(names, key=lambda name: hash(name))",
        "names.sort(key=id)",
        "heappush(queue, (cost, id(node), node))",
        "def __lt__(self, other):\n    return hash(self)",
    ],
)
def test_a_planted_hidden_input_is_found(line: str) -> None:
    assert len(unreproducible(ast.parse(line))) == 1


def test_a_class_may_compute_its_own_hash() -> None:
    assert not unreproducible(ast.parse("class Term:\n    def __hash__(self):\n        return hash(self.text)"))


def test_keyed_randomness_is_allowed() -> None:
    line = "np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, step, stream])))"
    assert not unreproducible(ast.parse(line))
