import numpy as np
import pytest
from numpy.typing import NDArray

from skolem.estimation.attributes import after_miss
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.coverage import Grid
from skolem.estimation.unexplained import Unexplained

GRID = Grid((0.6, 1.0, 0.3), 0.05)
NONE = np.zeros(len(GRID.centres), dtype=bool)
LEFT, RIGHT = (0.1, 0.3, 0.1), (0.1, -0.3, 0.1)
IS_THING = 0.9


def hits(*places: tuple[float, float, float], count: int = 5) -> NDArray[np.int64]:
    """So many readings at each of these places."""
    return GRID.count(np.array(places * count)) if places else np.zeros(len(GRID.centres), dtype=np.int64)


def after(before: Unexplained, shown: NDArray[np.int64], found: float = 0.9, y_above: float = -1.0) -> Unexplained:
    """A look whose detector says nothing, and would have reported what it sees beyond a certain y."""
    return before.after(shown, NONE, GRID, lambda middle: found * (middle[1] > y_above), IS_THING)


def overlooked(left: Unexplained) -> float:
    return left.prob_overlooked(GRID, EstimatorConfig())


NOTHING = Unexplained.nothing(GRID)
ONCE = after_miss(IS_THING, 0.9)
TWICE = after_miss(ONCE, 0.9)


def test_nothing_is_overlooked_where_nothing_was_hit() -> None:
    assert overlooked(NOTHING) == overlooked(after(NOTHING, hits())) == 0.0


def test_each_silent_look_makes_a_thing_less_likely() -> None:
    once = after(NOTHING, hits(LEFT))
    assert overlooked(once) == pytest.approx(ONCE)
    assert overlooked(after(once, hits(LEFT))) == pytest.approx(TWICE)


def test_silence_about_one_thing_says_nothing_about_another() -> None:
    first = after(NOTHING, hits(LEFT))
    both = after(first, hits(RIGHT), y_above=-1.0)
    assert overlooked(both) == pytest.approx(1.0 - (1.0 - TWICE) * (1.0 - ONCE))


def test_silence_of_a_look_that_could_not_report_it_says_nothing() -> None:
    assert overlooked(after(NOTHING, hits(RIGHT), y_above=0.0)) == pytest.approx(IS_THING)


def test_what_is_hit_beside_it_is_the_same_thing() -> None:
    once = after(NOTHING, hits(LEFT))
    x, y, z = LEFT
    assert overlooked(after(once, hits((x + 0.05, y, z)))) == pytest.approx(TWICE)


def test_few_readings_are_errors_until_further_looks_add_to_them() -> None:
    once = after(NOTHING, hits(LEFT, count=2))
    assert overlooked(once) == 0.0
    assert overlooked(after(once, hits(LEFT, count=2))) == pytest.approx(TWICE)


def test_what_a_look_explains_puzzles_no_more() -> None:
    once = after(NOTHING, hits(LEFT))
    explained = once.after(hits(), hits(LEFT) > 0, GRID, lambda _: 0.9, IS_THING)
    assert overlooked(explained) == 0.0
