"""The imports of every file of the product, followed through faces to the file that defines each name."""

import ast
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path, PurePosixPath
from typing import Final

PRODUCT: Final = "skolem"
INIT: Final = "__init__"


@dataclass(frozen=True, slots=True)
class File:
    """A Python file of the product.

    Attributes:
        path: From the root of the checkout.
        text: Its source.
        face: If it is the `__init__.py` of a lazy package, the stub beside it; otherwise empty.
    """

    path: PurePosixPath
    text: str
    face: str = ""

    @property
    def is_package(self) -> bool:
        """Whether this is an `__init__.py`."""
        return self.path.stem == INIT


@dataclass(frozen=True, slots=True)
class Import:
    """One import of one file of the product by another.

    Attributes:
        importer: The module that imports.
        written: The module that the import names.
        name: The member that it names; empty for the module as a whole.
        meant: The module in which that member is defined: another one than `written` if that is a face.
    """

    importer: str
    written: str
    name: str
    meant: str


@dataclass(frozen=True)
class House:
    """The files of the product by the names of their modules, and their imports.

    Imports inside functions and under TYPE_CHECKING count. So do texts that are only the name of a module, with or
    without a member after a colon, because such texts name modules to load later.
    """

    files: Mapping[str, File]

    @classmethod
    def at(cls, root: Path) -> "House":
        """Read the product in a checkout, in the folders that its `pyproject.toml` maps to packages."""
        config = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
        folders: dict[str, str] = config["tool"]["setuptools"]["package-dir"]
        found = {}
        for package, folder in sorted(folders.items()):
            for path in sorted((root / folder).rglob("*.py")):
                parts = path.relative_to(root / folder).with_suffix("").parts
                stub = path.with_suffix(".pyi")
                found[".".join((package, *parts)).removesuffix(f".{INIT}")] = File(
                    PurePosixPath(path.relative_to(root).as_posix()),
                    path.read_text(encoding="utf-8"),
                    stub.read_text(encoding="utf-8") if path.stem == INIT and stub.exists() else "",
                )
        return cls(found)

    def planted(self, module: str, text: str) -> "House":
        """Return this house with lines added to the end of a module, or with a new module of these lines."""
        path = PurePosixPath(*module.split(".")[1:]).with_suffix(".py")
        file = self.files.get(module, File(path, ""))
        return House({**self.files, module: replace(file, text=f"{file.text}\n{text}\n")})

    @cached_property
    def faces(self) -> dict[str, dict[str, str]]:
        """The modules of the public names of every lazy package."""
        return {module: dict(_offered(module, file.face)) for module, file in self.files.items() if file.face}

    @cached_property
    def imports(self) -> tuple[Import, ...]:
        """All imports, in the order of the importing modules."""
        return tuple(found for module in sorted(self.files) for found in self.imports_of(module))

    def imports_of(self, module: str) -> Iterator[Import]:
        """Yield the imports of one module from other modules of the product."""
        for written, name in _written(self.files[module].text):
            found = self._resolved(module, written, name)
            if found and found.meant != module:
                yield found

    def _resolved(self, importer: str, written: str, name: str) -> Import | None:
        if f"{written}.{name}" in self.files:
            written, name = f"{written}.{name}", ""
        if written not in self.files:
            return None
        return Import(importer, written, name, self.faces.get(written, {}).get(name, written))

    @cached_property
    def arrows(self) -> dict[str, frozenset[str]]:
        """The modules that every module imports; a face that is imported as a whole stands for all that it offers."""
        found: dict[str, set[str]] = {module: set(self.faces.get(module, {}).values()) for module in self.files}
        for one in self.imports:
            found[one.importer].add(one.meant)
        return {module: frozenset(others - {module}) for module, others in found.items()}

    def room_of(self, module: str) -> str:
        """Return the room of a module, which is its folder; a file beside rooms is a room of its own.

        Rooms are named by their path: `sim/planner`, `reasoner/agent.py`.
        """
        path = self.files[module].path
        beside_rooms = path.parent.as_posix() in self._folders_of_rooms and path.stem != INIT
        return path.as_posix() if beside_rooms else path.parent.as_posix()

    @cached_property
    def _folders_of_rooms(self) -> set[str]:
        return {file.path.parent.parent.as_posix() for file in self.files.values() if file.is_package}

    @cached_property
    def rooms(self) -> dict[str, tuple[str, ...]]:
        """The modules of every room that holds more than an `__init__.py`."""
        found: dict[str, list[str]] = {}
        for module in sorted(self.files):
            if not self.files[module].is_package:
                found.setdefault(self.room_of(module), []).append(module)
        return {room: tuple(modules) for room, modules in sorted(found.items())}

    @cached_property
    def room_arrows(self) -> dict[str, frozenset[str]]:
        """The other rooms that every room imports from."""
        found: dict[str, set[str]] = {room: set() for room in self.rooms}
        for room, modules in self.rooms.items():
            for module in modules:
                found[room] |= {self.room_of(meant) for meant in self.arrows[module]} & set(self.rooms) - {room}
        return {room: frozenset(others) for room, others in found.items()}

    def reachable(self, starts: Iterable[str]) -> dict[str, tuple[str, ...]]:
        """Return every module that these import, directly or through others, with the chain of imports to it."""
        ways: dict[str, tuple[str, ...]] = {start: (start,) for start in starts}
        todo = list(ways)
        for module in todo:  # the loop extends the list
            for other in sorted(self.arrows[module]):
                if other not in ways:
                    ways[other] = (*ways[module], other)
                    todo.append(other)
        return ways


def circles(arrows: Mapping[str, Iterable[str]]) -> list[tuple[str, ...]]:
    """Return the strongly connected parts of a graph that have more than one node, sorted (Tarjan 1972)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    path: list[str] = []
    found: list[tuple[str, ...]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        path.append(node)
        for other in sorted(arrows.get(node, ())):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in path:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            part = path[path.index(node) :]
            del path[path.index(node) :]
            found.extend([tuple(sorted(part))] if len(part) > 1 else [])

    for node in sorted(arrows):
        if node not in index:
            visit(node)
    return sorted(found)


def private_names(text: str) -> list[str]:
    """Return the private names that a file imports from other modules of the product, as written."""
    tree = ast.parse(text)
    found, modules = [], set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == PRODUCT:
            found += [f"{node.module}.{alias.name}" for alias in node.names if _is_private(alias.name)]
            modules |= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.Import):
            modules |= {a.asname or a.name for a in node.names if a.name.split(".")[0] == PRODUCT}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and _is_private(node.attr) and ast.unparse(node.value) in modules:
            found.append(ast.unparse(node))
    return found


def _is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__")


@cache
def _written(text: str) -> tuple[tuple[str, str], ...]:
    """Return module and member of each import, and of each text that names one; the member is empty for a module."""
    return tuple(_walked(ast.parse(text)))


def _walked(tree: ast.AST) -> Iterator[tuple[str, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield from ((node.module, alias.name) for alias in node.names)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            module, _, member = node.value.partition(":")
            if module.startswith(f"{PRODUCT}.") and all(part.isidentifier() for part in module.split(".")):
                yield module, member


def _offered(package: str, stub: str) -> Iterator[tuple[str, str]]:
    """Yield the public names of a face, with the module of each by the relative imports of the face's stub."""
    for node in ast.walk(ast.parse(stub)):
        if isinstance(node, ast.ImportFrom):
            module = ".".join(filter(None, (package, node.module))) if node.level else node.module or ""
            for alias in node.names:
                yield alias.asname or alias.name, module if node.module else f"{package}.{alias.name}"
