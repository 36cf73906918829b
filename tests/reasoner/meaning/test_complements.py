"""Complements: an object has a property, or one of its complements, and never both."""

import pytest
from hypothesis import given, strategies as st
from kit.papers import shipped

from skolem.reasoner.meaning.complements import complements
from skolem.traces.messages import ColourMeaning, HsvUnion, HsvVolume, Meaning, TypeIs, TypeIsNot, WeightInterval

WORDS = {word: m for word, m in sorted(shipped().vocabulary.meanings.items()) if isinstance(m, ColourMeaning)}
UNIT = st.floats(0.0, 1.0, exclude_max=True)
EDGES = st.integers(0, 10).map(lambda k: k / 10)


@st.composite
def boxes(draw: st.DrawFn) -> HsvVolume:
    def span() -> tuple[float, float]:
        low, high = sorted(draw(st.lists(EDGES, min_size=2, max_size=2, unique=True)))
        return low, high

    hue = draw(st.lists(EDGES.filter(lambda edge: edge < 1.0), min_size=2, max_size=2, unique=True))
    return HsvVolume(hue=(hue[0], hue[1]), saturation=span(), value=span())


def inside(meaning: ColourMeaning, hsv: tuple[float, float, float]) -> int:
    """Return how many boxes contain a colour, by the definition of a box: low <= component < high, hue on a circle."""
    count = 0
    for box in meaning.boxes:
        (low, high), h = box.hue, hsv[0]
        around = low <= h < high if low <= high else h >= low or h < high
        count += around and all(span[0] <= x < span[1] for span, x in ((box.saturation, hsv[1]), (box.value, hsv[2])))
    return count


def other_colours(meaning: ColourMeaning) -> HsvUnion:
    ((name, other),) = complements("word", meaning).items()
    assert name == "not__word"
    assert isinstance(other, HsvUnion)
    return other


@pytest.mark.parametrize("word", WORDS)
@given(hsv=st.tuples(UNIT, UNIT, UNIT))
def test_a_colour_is_in_a_word_or_in_one_box_of_its_complement(word: str, hsv: tuple[float, float, float]) -> None:
    meaning = WORDS[word]
    assert (inside(meaning, hsv) > 0) + inside(other_colours(meaning), hsv) == 1


@given(st.lists(boxes(), min_size=1, max_size=4), st.tuples(UNIT, UNIT, UNIT))
def test_boxes_that_overlap_or_go_around_leave_disjoint_boxes(
    some: list[HsvVolume], hsv: tuple[float, float, float]
) -> None:
    meaning = HsvUnion(boxes=tuple(some))
    assert (inside(meaning, hsv) > 0) + inside(other_colours(meaning), hsv) == 1


def test_the_complement_of_a_type_is_every_other_type_and_that_of_it_the_type() -> None:
    assert complements("can", TypeIs(type="can")) == {"not__can": TypeIsNot(type="can")}
    assert complements("x", TypeIsNot(type="can")) == {"not__x": TypeIs(type="can")}


@given(st.floats(0.0, 5.0), st.one_of(st.none(), st.floats(0.01, 5.0)), st.floats(0.0, 20.0))
def test_a_weight_is_in_an_interval_or_on_one_side_of_it(low: float, width: float | None, kg: float) -> None:
    def has(meaning: Meaning) -> bool:
        assert isinstance(meaning, WeightInterval)
        return meaning.at_least_kg <= kg and (meaning.below_kg is None or kg < meaning.below_kg)

    interval = WeightInterval(at_least_kg=low, below_kg=None if width is None else low + width)
    sides = complements("light", interval)
    assert has(interval) + sum(map(has, sides.values())) == 1
    if low > 0 and width is not None:
        assert list(sides) == ["not__light__below", "not__light__above"]
    else:
        assert set(sides) <= {"not__light"}
