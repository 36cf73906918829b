"""The page on skolem as a library: its scripts are short, are what it quotes, and print what it shows."""

import importlib
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from kit.places import ROOT

PAGE = (ROOT / "docs" / "library.md").read_text(encoding="utf-8")
SCRIPTS = sorted((ROOT / "docs" / "library").glob("*.py"))
REFERENCE = (ROOT / "docs" / "api" / "index.md").read_text(encoding="utf-8")
MOST_LINES = 30  # that say something
SESSION = re.compile(r"^```\n\$ python (\S+)(.*)\n((?:.*\n)*?)```$", re.MULTILINE)


def test_the_page_quotes_every_script_in_full() -> None:
    quoted = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    assert sorted(quoted) == sorted(script.read_text(encoding="utf-8") for script in SCRIPTS)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_script_has_at_most_thirty_lines_beside_empty_ones(script: Path) -> None:
    lines = script.read_text(encoding="utf-8").splitlines()
    assert sum(bool(line.strip()) for line in lines) <= MOST_LINES


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_script_imports_public_names_alone(script: Path) -> None:
    imported = re.findall(r"^from (skolem[\w.]*) import (.+)$", script.read_text(encoding="utf-8"), re.MULTILINE)
    assert imported
    for package, names in imported:
        for name in names.split(","):
            plain = name.split(" as ")[0].strip()
            assert plain in importlib.import_module(package).__all__ or (package, plain) == (
                "skolem.traces",
                "messages",
            )


@pytest.mark.parametrize("shown", SESSION.findall(PAGE), ids=lambda shown: Path(shown[0]).stem)
def test_a_script_prints_what_the_page_shows(shown: tuple[str, str, str], tmp_path: Path) -> None:
    script, arguments, printed = shown
    given = [str(ROOT / word) if (ROOT / word).is_file() else word for word in shlex.split(arguments)]
    command = [sys.executable, str(ROOT / script), *given]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.stderr, done.stdout) == ("", printed)


def test_the_page_shows_what_every_script_prints() -> None:
    assert sorted(script for script, _, _ in SESSION.findall(PAGE)) == [
        path.relative_to(ROOT).as_posix() for path in SCRIPTS
    ]


def test_the_reference_lists_every_public_name_once() -> None:
    faces = re.findall(r"^## (skolem\S*)$", REFERENCE, re.MULTILINE)
    promised = [f"{face}.{name}" for face in faces for name in importlib.import_module(face).__all__]
    assert re.findall(r"^::: (\S+)$", REFERENCE, re.MULTILINE) == promised


def test_every_package_that_promises_names_stands_in_the_reference() -> None:
    faces = set(re.findall(r"^## (skolem\S*)$", REFERENCE, re.MULTILINE))
    packages = {
        "skolem." + path.parent.relative_to(ROOT).as_posix().replace("/", ".")
        for folder in ("rules", "reasoner", "estimation", "sim", "traces", "tools")
        for path in (ROOT / folder).rglob("__init__.py")
    }
    assert {package for package in packages if importlib.import_module(package).__all__} == faces
