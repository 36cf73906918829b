"""G8: what goals cannot say in the paper is written down for users: what they can say now, or that they cannot."""

from kit.places import ROOT


def test_the_declared_limits_are_documented() -> None:
    """ "Definite descriptions ... are of great importance, but not handled in our current implementation"."""
    text = " ".join(
        path.read_text(encoding="utf-8").lower() for path in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    )
    for limit in ("the only one", "negation", "natural language", "dialogue"):
        assert limit in text, limit
