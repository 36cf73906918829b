"""Guards for the mapping of folders to `skolem.<folder>` and for what ships: mistakes that stay silent otherwise."""

import fnmatch
import os
import re
import subprocess
import sys
import tomllib
from importlib import import_module
from importlib.metadata import entry_points, requires, version
from importlib.resources import files
from pathlib import Path

import pytest
from kit.places import ROOT
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from skolem.reasoner.rulebook.book import RULE_FILES
from skolem.tools.loop.source import source_sha256

CONFIG = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
SETUPTOOLS = CONFIG["tool"]["setuptools"]
MAPPING: dict[str, str] = SETUPTOOLS["package-dir"]
FOLDERS = set(MAPPING.values())
TOP = "package"  # the folder of `skolem` itself
LOCK = (ROOT / "requirements.lock").read_text(encoding="utf-8").splitlines()
SHIPPED: list[str] = SETUPTOOLS["package-data"]["*"]
MACHINE_PATH = re.compile(r"(?<![\w.*$})~-])/(tmp|work|root|home)(?![\w-])")
NOT_OURS = {"build", "dist", "out", "node_modules", "__pycache__"}


def packages() -> set[str]:
    """Return the folder of every package and sub-package, from the root of the checkout."""
    return {path.parent.relative_to(ROOT).as_posix() for d in FOLDERS for path in (ROOT / d).rglob("__init__.py")}


def test_the_package_list_names_every_folder_with_an_init_file() -> None:
    """A sub-package that is not listed works when editable and is missing from the wheel."""
    named = {".".join(("skolem", *folder.split("/"))) for folder in packages() - {TOP}}
    assert SETUPTOOLS["packages"] == sorted(named | {"skolem"})


def test_no_python_file_hides_in_a_folder_that_is_no_package() -> None:
    assert {
        path.parent.relative_to(ROOT).as_posix() for d in FOLDERS for path in (ROOT / d).rglob("*.py")
    } == packages()


def test_every_folder_at_the_top_is_mapped() -> None:
    assert MAPPING == {f"skolem.{folder}": folder for folder in FOLDERS - {TOP}} | {"skolem": TOP}


def test_the_type_checkers_links_mirror_the_mapping(type_farm: Path) -> None:
    top = {path.name: path.resolve() for path in (ROOT / TOP).iterdir() if path.is_file()}
    parts = {folder: (ROOT / folder).resolve() for folder in FOLDERS - {TOP}}
    assert {link.name: link.resolve() for link in type_farm.iterdir()} == top | parts


def test_bare_folder_names_are_banned_for_every_folder() -> None:
    """From the root of the checkout `import reasoner` works too, and loads every module a second time."""
    assert set(CONFIG["tool"]["ruff"]["lint"]["flake8-tidy-imports"]["banned-api"]) == FOLDERS


def test_every_package_says_that_it_is_typed() -> None:
    assert all((ROOT / folder / "py.typed").exists() for folder in FOLDERS)


def test_everything_in_a_package_folder_is_code_or_ships_as_data() -> None:
    lost = {
        path.relative_to(ROOT).as_posix()
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and not any(fnmatch.fnmatch(path.name, pattern) for pattern in [*SHIPPED, "*.py", "*.pyc"])
    }
    assert not lost


def test_the_rule_files_shipped_are_the_ones_loaded() -> None:
    shipped = {path.name for path in files("skolem.rules").iterdir() if path.name.endswith(".lp")}
    assert shipped == {path.name for path in (ROOT / "rules").rglob("*.lp")} == {f"{name}.lp" for name in RULE_FILES}


def test_the_command_is_installed() -> None:
    (command,) = entry_points(group="console_scripts", name="skolem")
    assert command.value == CONFIG["project"]["scripts"]["skolem"]


def said(cwd: Path, *arguments: str) -> str:
    """Return what Python prints, started in a folder."""
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, cwd=cwd, check=True)
    return done.stdout.strip()


@pytest.mark.parametrize("cwd", [ROOT, Path("/")], ids=["in the checkout", "elsewhere"])
def test_the_version_and_the_command_are_there_wherever_python_starts(cwd: Path) -> None:
    assert said(cwd, "-c", "import skolem; print(skolem.__version__)") == version("skolem")
    assert said(cwd, "-m", "skolem", "--version") == f"skolem {version('skolem')}"
    assert said(cwd, "-c", "import skolem, skolem.traces.errors as e; print(e.__file__)") == str(
        ROOT / "traces" / "errors.py"
    )


def test_the_package_itself_promises_its_version_and_nothing_else() -> None:
    skolem = import_module("skolem")
    assert skolem.__all__ == ("__version__",)
    assert skolem.__version__ == CONFIG["project"]["version"]
    with pytest.raises(AttributeError, match="'skolem' has no attribute 'Agent'"):
        _ = skolem.Agent


def test_importing_the_package_by_itself_looks_nothing_up() -> None:
    assert said(ROOT, "-c", "import sys, skolem; print('importlib.metadata' in sys.modules)") == "False"


def pinned() -> dict[str, str]:
    """Return version by normalised name of every line of the lock file."""
    found = (re.fullmatch(r"([\w.-]+)==([\w.]+)( ; .+)?", line) for line in LOCK)
    return {match[1]: match[2] for match in found if match}


def test_the_lock_file_holds_exact_versions_and_nothing_else() -> None:
    """No index, host, path or option: any machine's own package index serves."""
    assert len(pinned()) == len(LOCK)


def test_every_dependency_is_locked_at_a_version_that_the_metadata_allow() -> None:
    locked = pinned()
    for line in requires("skolem") or ():
        requirement = Requirement(line)
        version = locked.get(canonicalize_name(requirement.name))
        assert version, f"{requirement.name} is not in requirements.lock: make lock"
        assert requirement.specifier.contains(version), f"{line} does not allow {version}: make lock"


def test_every_direct_dependency_has_its_licence_noted() -> None:
    notices = canonicalize_name((ROOT / "THIRD_PARTY_NOTICES.md").read_text(encoding="utf-8"))
    missing = {name for name in pinned() if f"| {name} |" not in notices} - {"colorama"}  # Windows only
    assert not missing


def test_the_hash_of_the_program_notices_a_change_in_a_room(tmp_path: Path) -> None:
    for folder in sorted(packages()):
        (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    hashes = {source_sha256(tmp_path)}
    decisive = sorted(folder for folder in packages() if folder.split("/")[0] not in ("rules", "tools", TOP))
    for folder in decisive:
        (tmp_path / folder / "planted.py").touch()
        hashes.add(source_sha256(tmp_path))
    assert len(hashes) == len(decisive) + 1


def test_scripts_that_are_called_can_be_executed() -> None:
    assert all(os.access(script, os.X_OK) for script in (ROOT / ".ci").iterdir())


def test_make_offers_what_the_readme_names() -> None:
    targets = set(re.findall(r"`make (\w+)`|^make (\w+)", (ROOT / "README.md").read_text(encoding="utf-8"), re.M))
    named = {name for pair in targets for name in pair if name}
    assert {"demo", "test"} <= named
    for target in sorted(named):
        command = ["make", "--dry-run", "--no-print-directory", target]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)


def texts() -> list[Path]:
    """Return every text file of the repository."""
    found = []
    for folder, inner, names in os.walk(ROOT):
        inner[:] = [d for d in inner if d == ".ci" or not (d.startswith(".") or d in NOT_OURS or "egg-info" in d)]
        found += [Path(folder) / name for name in names if not name.endswith((".mcap", ".pyc", ".png"))]
    return found


def test_the_scan_for_machine_paths_finds_them() -> None:
    planted = ["see /" + "tmp/x", '"/' + 'work"', "(/" + "root/.cache)", "cd /" + "home/me"]
    assert all(MACHINE_PATH.search(line) for line in planted)
    assert not MACHINE_PATH.search("frames/root, a/work, /workspace, tmp_path / 'out', https://example.org/tmp")


def test_no_text_names_a_place_on_somebodys_machine() -> None:
    places = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in texts()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if MACHINE_PATH.search(line)
    ]
    assert not places
