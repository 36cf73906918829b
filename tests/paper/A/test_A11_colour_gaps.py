"""A11, gaps: colours that have no name are noticed when rules are loaded."""

from pathlib import Path

from kit.papers import shipped

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook


def test_gaps_between_colours_are_reported(tmp_path: Path) -> None:
    """ "We define color names as fixed volumes in HSV space": who narrows a colour hears of the colours it leaves."""
    mine = tmp_path / "mine.lp"
    mine.write_text("colour(orange, 20, 42, 60, 100, 72, 90).\n")
    messages = [warning.message for warning in Rulebook.load(Queries, [mine]).warnings]
    assert messages == [
        "warning: no colour for hue 12 to 20 degrees, saturation 60 to 100 %, value 72 to 100 %",
        "warning: no colour for hue 20 to 42 degrees, saturation 60 to 100 %, value 90 to 100 %",
    ]
    assert shipped().warnings == ()
