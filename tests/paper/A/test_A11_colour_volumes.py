"""A11: the names of colours are fixed volumes, given in one place."""

from pathlib import Path

from kit.papers import shipped, with_own_rules

from skolem.traces.messages import ColourMeaning

COLOURS = {
    "black",
    "grey",
    "white",
    "brown",
    "red",
    "orange",
    "yellow",
    "lime",
    "green",
    "turquoise",
    "blue",
    "purple",
    "pink",
}


def test_colours_are_one_table_in_one_file() -> None:
    """ "We define color names as fixed volumes in HSV space." """
    having = [name for name, text in shipped().files.items() if b"\ncolour(" in text]
    assert having == ["vocabulary.lp"]
    volumes = {w: m for w, m in shipped().vocabulary.meanings.items() if isinstance(m, ColourMeaning)}
    assert set(volumes) == COLOURS
    stated = shipped().files["vocabulary.lp"].decode().splitlines()
    assert sum(line.startswith("colour(") for line in stated) == sum(len(m.boxes) for m in volumes.values())


def test_volumes_that_overlap_are_reported_with_their_place(tmp_path: Path) -> None:
    """ "The semantics of color expressions in natural language is subtle": two names for one colour are noticed."""
    assert shipped().warnings == ()
    grass = with_own_rules(tmp_path, "% mine\ncolour(grass, 100, 120, 60, 100, 50, 100).\n")
    assert [(w.line, "grass and green overlap" in w.message) for w in grass.warnings] == [(2, True)]
