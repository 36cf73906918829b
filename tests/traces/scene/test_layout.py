"""Places for labels: near what they speak of, and off everything else."""

import math

import numpy as np
import pytest

from skolem.traces.scene.eye import VIEW_PX, Eye
from skolem.traces.scene.layout import Seen, Wish, arrange, dots, half_size

ROOM = (800.0, 600.0)
MIDDLE = (400.0, 300.0)
EYE = Eye(at=(2.95, -0.75, 2.55), target=(0.3, -0.12, 0.68))


def corners(text: str, middle: tuple[float, float]) -> tuple[float, float, float, float]:
    (wide, high), (x, y) = half_size(text), middle
    return x - wide, y - high, x + wide, y + high


def overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return all(one[i] < other[i + 2] and other[i] < one[i + 2] for i in (0, 1))


def test_a_label_with_nothing_around_stands_where_it_wants() -> None:
    assert arrange([Wish("o1: can", (MIDDLE,))], [], ROOM) == [pytest.approx(MIDDLE)]


def test_labels_that_want_the_same_place_stand_apart_and_near() -> None:
    wishes = [Wish(f"o{i}: can, green, Den .00", (MIDDLE,), MIDDLE) for i in range(5)]
    middles = arrange(wishes, [], ROOM)
    boxes = [corners(wish.text, middle) for wish, middle in zip(wishes, middles, strict=True)]
    assert not any(overlap(boxes[i], boxes[j]) for i in range(5) for j in range(i))
    assert max(math.dist(middle, MIDDLE) for middle in middles) < 200.0


def test_a_label_does_not_cover_what_is_worth_seeing() -> None:
    thing: Seen = (380.0, 280.0, 420.0, 320.0, 500.0)
    (middle,) = arrange([Wish("o1", (MIDDLE,))], [thing], ROOM)
    assert not overlap(corners("o1", middle), thing[:4])


def test_a_label_stays_in_the_picture() -> None:
    (middle,) = arrange([Wish("a long label", ((2.0, 1.0),))], [], ROOM)
    assert min(corners("a long label", middle)) >= 0.0


def test_of_several_places_the_free_one_is_taken() -> None:
    left, right = (200.0, 300.0), (600.0, 300.0)
    crowd: Seen = (0.0, 0.0, 400.0, 600.0, 1e6)
    assert arrange([Wish("_reg1_", (left, right))], [crowd], ROOM) == [pytest.approx(right)]


def test_no_line_to_a_label_runs_through_another_label() -> None:
    below, above = (400.0, 340.0), (400.0, 300.0)
    first, second = arrange([Wish("_reg1_: 33 % unsearched", (above,)), Wish("o1", ((400.0, 260.0),), below)], [], ROOM)
    end = np.clip(below, *np.split(np.array(corners("o1", second)), 2))
    line = np.linspace(below, end, 50)
    left, top, right, bottom = corners("_reg1_: 33 % unsearched", first)
    assert not np.any((line[:, 0] > left) & (line[:, 0] < right) & (line[:, 1] > top) & (line[:, 1] < bottom))


def test_in_a_picture_shown_larger_labels_are_so_many_of_its_pixels_smaller() -> None:
    wishes = [Wish("o1", (MIDDLE,)), Wish("o2", (MIDDLE,))]
    full, half = (np.array(arrange(wishes, [], ROOM, scale)) - MIDDLE for scale in (1.0, 0.5))
    np.testing.assert_allclose(half, full / 2.0)


def test_the_eye_sees_its_target_in_the_middle() -> None:
    column, row, metres = EYE.pixels([EYE.target])[0]
    assert (column, row) == pytest.approx((VIEW_PX[0] / 2.0, VIEW_PX[1] / 2.0))
    assert metres > 0.0


@pytest.mark.parametrize("nearer", [1.0, 0.7])
def test_a_moved_point_is_seen_where_it_was_moved_to(nearer: float) -> None:
    before = EYE.pixels([(1.3, 0.2, 0.7)])[0]
    after = EYE.pixels([EYE.moved((1.3, 0.2, 0.7), 60.0, -35.0, nearer)])[0]
    assert after == pytest.approx(before * (1.0, 1.0, nearer) + (60.0, -35.0, 0.0))


def test_a_line_to_behind_the_eye_is_not_drawn_out_for_ever() -> None:
    """What is behind the eye is projected very far away."""
    before, behind = EYE.pixels([EYE.target, (30.0, -1.0, 0.7)])[:, :2]
    assert np.all(np.isfinite(behind))
    assert len(dots(before, behind, 14.0, 1.0)) <= 200
