"""A11, gaps: hues that have no name are noticed when rules are loaded."""

from pathlib import Path

from kit.papers import shipped

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook


def test_gaps_between_colours_are_reported(tmp_path: Path) -> None:
    """ "We define color names as fixed volumes in HSV space": who narrows a colour hears of the hues it leaves."""
    mine = tmp_path / "mine.lp"
    mine.write_text("colour(green, 100, 150, 40, 100, 20, 100).\n")
    messages = [warning.message for warning in Rulebook.load(Queries, [mine]).warnings]
    assert messages == [
        "warning: no colour for the hues 90 to 100 degrees",
        "warning: no colour for the hues 150 to 162 degrees",
    ]
    assert shipped().warnings == ()
