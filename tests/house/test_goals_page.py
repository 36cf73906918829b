"""docs/goals.md: every example is a goal that can be read and achieved in some world."""

import re

import pytest
from kit.papers import shipped
from kit.places import ROOT

from skolem.reasoner.language.cursor import ALIASES
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.planning.contradictions import contradictions
from skolem.reasoner.planning.relations import misused, too_sure

PAGE = (ROOT / "docs" / "goals.md").read_text(encoding="utf-8")
NAMES = ("table1", "table2", "sodaE")
AROUND = {
    "Heads": "{}",
    "Descriptions": "exists o. B(Den({}, o), 0.9)",
    "Inside a description": "exists o. B(Den(lambda x. {}, o), 0.9)",
    "What is believed": "{}",
}


def section(heading: str) -> str:
    """Return the text below a heading of the page."""
    return PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]


def examples() -> list[str]:
    """Return the first columns of the tables as goals, and the blocks."""
    rows = [
        around.format(row.replace("\\|", "|"))
        for heading, around in AROUND.items()
        for row in re.findall(r"^\| `(.+?)` \| [A-Za-z]", section(heading), re.MULTILINE)
    ]
    return rows + re.findall(r"^```\n(.+?)\n```$", PAGE, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("text", examples())
def test_every_example_can_be_read_and_meant(text: str) -> None:
    vocabulary = shipped().vocabulary
    goal = parse_goal(text, vocabulary.words(), NAMES)
    assert misused(goal, vocabulary) + too_sure(goal, 0.99) + contradictions(goal, vocabulary) == []


def test_each_kind_of_section_has_examples() -> None:
    assert all(section(heading).count("\n| `") >= 4 for heading in AROUND)
    assert len(examples()) >= 40


def test_every_sign_that_is_read_stands_on_the_page() -> None:
    assert [each for each in ALIASES if each not in section("Other spellings")] == []


@pytest.mark.parametrize("body", re.findall(r"\(`(.+?)`\)", section("Goals that can never be achieved")))
def test_what_the_page_calls_contradictory_is_told_of(body: str) -> None:
    vocabulary = shipped().vocabulary
    goal = parse_goal(AROUND["Inside a description"].format(body), vocabulary.words(), NAMES)
    assert len(contradictions(goal, vocabulary)) == 1
