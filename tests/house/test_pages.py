"""Every page for readers: what it names is there, be it a file, a link, a verb, an option, a target or a module."""

import importlib
import re
import shlex
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import typer
from kit.places import ROOT

from skolem.tools.cli import app
from skolem.tools.loop.worlds import GROUP

FOLDERS = "rules|reasoner|estimation|sim|traces|tools|package|scenarios|tests|benchmarks|docs|\\.ci"
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
DECISIONS = sorted((ROOT / "docs" / "decisions").glob("*.md"))
PATH = re.compile(rf"(?<![\w./*:-])(?:{FOLDERS})/[\w./*-]*")
LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]*)?\)")
FENCED = re.compile(r"^```\w*\n(.*?)^```$", re.DOTALL | re.MULTILINE)
SPAN = re.compile(r"`([^`]+)`")
FILE_NAME = re.compile(r"[\w-]+\.(?:py|lp|yaml|toml|mjs)")
MODULE = re.compile(r"\bskolem(?:\.[A-Za-z_]\w*)+")
EXAMPLES = {"my_rules.lp", "scenarios/SCENARIO.yaml"}  # names that stand for the reader's own
each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())


def spans(text: str) -> list[str]:
    """Return what stands between single backticks, on one line each."""
    return [" ".join(span.split()) for span in SPAN.findall(FENCED.sub("", text))]


def typed(text: str) -> Iterator[str]:
    """Yield what a reader may type: lines of blocks, without prompt and comment, and what stands between backticks."""
    for block in FENCED.findall(text):
        for line in block.replace("\\\n", " ").splitlines():
            yield line.removeprefix("$ ").partition(" #")[0].strip()
    yield from spans(text)


def commands(text: str) -> list[list[str]]:
    """Return the words of every `skolem` command that a page names."""
    return [shlex.split(line)[1:] for line in typed(text) if line.startswith("skolem ")]


def missing(words: list[str]) -> str:
    """Return the first verb or option of a command that skolem does not have; empty if it has all."""
    command: Any = typer.main.get_command(app)
    while words and hasattr(command, "get_command") and not words[0].startswith("-"):
        name, *words = words
        command = command.get_command(None, name)
        if command is None:
            return name
    known = {"--help", "-h"} | {name for param in command.params for name in (*param.opts, *param.secondary_opts)}
    return next((word for word in words if word.startswith("-") and word.partition("=")[0] not in known), "")


@each_page
def test_every_path_that_a_page_names_exists(page: Path) -> None:
    named = {name.rstrip(".") for name in PATH.findall(page.read_text(encoding="utf-8"))} - EXAMPLES
    assert not [name for name in sorted(named) if not any(ROOT.glob(name.rstrip("/")))]


@each_page
def test_every_file_that_a_page_names_alone_is_somewhere_in_the_checkout(page: Path) -> None:
    known = {path.name for folder in FOLDERS.replace("\\", "").split("|") for path in (ROOT / folder).rglob("*")}
    known |= {path.name for path in ROOT.iterdir()}
    alone = {span for span in spans(page.read_text(encoding="utf-8")) if FILE_NAME.fullmatch(span)}
    assert not sorted(alone - known - EXAMPLES)


@each_page
def test_every_link_of_a_page_leads_to_a_file(page: Path) -> None:
    links = [link for link, _ in LINK.findall(page.read_text(encoding="utf-8")) if "://" not in link]
    assert not [link for link in links if not (page.parent / link).exists()]


@each_page
def test_every_command_that_a_page_names_exists_with_its_options(page: Path) -> None:
    found = {" ".join(words): missing(words) for words in commands(page.read_text(encoding="utf-8"))}
    assert not {command: word for command, word in found.items() if word}


@each_page
def test_every_target_of_make_that_a_page_names_exists(page: Path) -> None:
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    named = {line.split()[1] for line in typed(page.read_text(encoding="utf-8")) if line.startswith("make ")}
    assert named <= targets


@pytest.mark.parametrize("page", [p for p in PAGES if p.name != "CHANGELOG.md"], ids=lambda p: p.stem)
def test_every_module_or_member_that_a_page_names_can_be_imported(page: Path) -> None:
    """The list of changes may name what is gone."""
    named = {name for code in typed(page.read_text(encoding="utf-8")) for name in MODULE.findall(code)} - {GROUP}
    assert not [name for name in sorted(named) if not importable(name)]


def importable(name: str) -> bool:
    """Tell whether a dotted name is a module, or a member of one."""
    above, _, member = name.rpartition(".")
    try:
        return find_spec(name) is not None or hasattr(importlib.import_module(above), member)
    except ModuleNotFoundError:
        return hasattr(importlib.import_module(above), member) if find_spec(above) else False


def test_a_misspelt_verb_option_or_module_would_be_found() -> None:
    assert missing(["runn", "x.yaml"]) == "runn"
    assert missing(["rules", "chek"]) == "chek"
    assert missing(["run", "x.yaml", "--sed", "3"]) == "--sed"
    assert missing(["replay", "x.mcap", "--set", "threshold=.8"]) == ""
    assert not importable("skolem.traces.file.rader")


def test_a_decision_begins_with_its_number_and_subject_and_says_its_status() -> None:
    assert [int(path.name[:4]) for path in DECISIONS] == list(range(1, len(DECISIONS) + 1))
    for path in DECISIONS:
        heading, _, status = path.read_text(encoding="utf-8").splitlines()[:3]
        assert re.fullmatch(rf"# {int(path.name[:4])}\. [A-Z].{{3,55}}", heading), path
        assert status.removeprefix("**").startswith("Status:"), path


def test_the_glossary_has_each_word_once_in_order_in_a_line_or_two() -> None:
    words, meanings = glossary_rows()
    assert 40 <= len(words) <= 60
    assert words == sorted(set(words), key=str.lower)
    assert all(10 < len(meaning) <= 120 for meaning in meanings)


def glossary_rows() -> tuple[list[str], list[str]]:
    """Return the words of the glossary's first table, and what each means."""
    page = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").partition("\n## ")[0]
    rows = re.findall(r"^\| ([^|]+) \| ([^|]+) \|$", page, re.MULTILINE)[1:]
    return [word for word, _ in rows], [meaning for _, meaning in rows]


def test_the_page_that_names_every_folder_of_the_product_names_no_other() -> None:
    """README's table of folders is a reader's first map."""
    table = re.findall(r"^\| `(\w+)/` \|", (ROOT / "README.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(table) == sorted(FOLDERS.split("|")[:7])
