import math

import pytest
from kit.tabletop import TYPES

from skolem.sim.detector.likelihood import MIXED, OUTLINE_SD_PER_M2, likeness, type_log_likelihood

FAR_M, NEAR_M = 2.0, 1.0
SOUND_M = 0.0005  # an error that depth noise explains


def test_without_errors_it_is_nought_at_any_distance() -> None:
    assert [type_log_likelihood(0.0, 0.0, distance) for distance in (0.0, NEAR_M, FAR_M)] == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("distance_m", [0.3, NEAR_M, FAR_M])
def test_each_further_error_makes_a_type_less_likely_however_large_it_is(distance_m: float) -> None:
    errors = [0.0, 0.001, 0.003, 0.01, 0.03, 0.1]
    heights = [type_log_likelihood(error, 0.0, distance_m) for error in errors]
    outlines = [type_log_likelihood(0.0, error, distance_m) for error in errors]
    assert heights == sorted(set(heights), reverse=True)
    assert outlines == sorted(set(outlines), reverse=True)


def test_too_high_and_too_low_are_equally_unlikely() -> None:
    assert type_log_likelihood(0.004, 0.001, NEAR_M) == type_log_likelihood(-0.004, 0.001, NEAR_M)


def test_an_error_tells_less_from_afar() -> None:
    assert type_log_likelihood(0.002, 0.0, FAR_M) > type_log_likelihood(0.002, 0.0, NEAR_M) + 5.0


def test_three_millimetres_of_height_tell_types_apart_at_arms_length() -> None:
    right, wrong = type_log_likelihood(SOUND_M, 0.001, NEAR_M), type_log_likelihood(0.003 - SOUND_M, 0.001, NEAR_M)
    assert right - wrong > math.log(0.99 / 0.01)


def test_a_cluster_whose_outline_is_of_no_single_thing_says_little_of_the_type() -> None:
    looks_right, looks_wrong = type_log_likelihood(0.0, 0.009, NEAR_M), type_log_likelihood(0.05, 0.011, NEAR_M)
    assert 0.0 < looks_right - looks_wrong < math.log(2.0)


def test_an_outline_that_is_six_sds_off_takes_the_word_from_the_height() -> None:
    """One cluster in a hundred is not one thing: that explains such an outline better than one thing's errors do."""
    outline_m = 6.5 * OUTLINE_SD_PER_M2
    right, wrong = type_log_likelihood(0.0, outline_m, NEAR_M), type_log_likelihood(0.003, outline_m, NEAR_M)
    assert 0.0 < right - wrong < math.log(2.0)


def test_no_type_is_ruled_out_beyond_what_a_mixed_cluster_allows() -> None:
    assert type_log_likelihood(0.05, 0.0, NEAR_M) > math.log(MIXED) - math.log(1e5)


def test_a_thing_is_most_like_its_own_type() -> None:
    for name, seen in TYPES.items():
        like = {other: likeness(seen, kind, NEAR_M) for other, kind in TYPES.items()}
        assert like[name] == 0.0
        assert all(value < 0.0 for other, value in like.items() if TYPES[other].size_m != seen.size_m)
