"""Calibration: what counts as a claim, when it is true, and how errors are compared with their covariances."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from kit.recordings import recorded
from scipy.stats import chi2

from skolem.tools.sweep.calibration import CLAIMS, Calibration, Errors, calibration_of
from skolem.tools.sweep.calibration_tables import calibration_tables


def test_claims_that_hold_as_often_as_promised_have_no_calibration_error() -> None:
    found = Calibration()
    for i in range(100):
        found.claim("On", 0.75, i % 4 != 0)
    assert found.ece("On") == pytest.approx(0.0)
    assert found.ece("Den") is None


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.booleans()), min_size=1, max_size=30))
def test_the_calibration_error_is_the_mean_distance_of_promise_and_share_in_ten_intervals(
    claims: list[tuple[float, bool]],
) -> None:
    found = Calibration()
    for p, true in claims:
        found.claim("exists", p, true)
    bins: dict[int, list[tuple[float, bool]]] = {}
    for p, true in claims:
        bins.setdefault(min(9, int(p * 10)), []).append((p, true))
    off = sum(abs(sum(p for p, _ in each) - sum(true for _, true in each)) for each in bins.values())
    assert found.ece("exists") == pytest.approx(off / len(claims))


def test_errors_as_large_as_their_covariance_says_make_one_for_each_degree_of_freedom() -> None:
    found, rng = Calibration(), np.random.default_rng(1)
    covariance = np.array([[0.04, 0.01], [0.01, 0.09]])
    for off in rng.multivariate_normal((0.0, 0.0), covariance, 500):
        found.error("objects", tuple(off), covariance)
    errors = found.errors["objects"]
    low, high = errors.band(0.99)
    assert errors.freedom == 1000
    assert low < errors.nees / errors.freedom < high
    assert (low, high) == pytest.approx((chi2.ppf(0.005, 1000) / 1000, chi2.ppf(0.995, 1000) / 1000))


def test_the_band_narrows_around_one_with_the_number_of_errors() -> None:
    few, many = Errors(freedom=10).band(0.95), Errors(freedom=1000).band(0.95)
    assert few[0] < many[0] < 1.0 < many[1] < few[1]


def test_without_noise_all_that_was_sensed_is_true() -> None:
    found = calibration_of([recorded("sim1_green", 0, "symbolic", ("noise=none",))])
    for kind in ("exists", "type", "colour word", "On"):
        claims = sum(each.claims for each in found.claims[kind])
        assert claims
        assert sum(each.hits for each in found.claims[kind]) == claims, kind
    assert found.errors["base"].freedom == 3
    assert found.errors["base"].nees < chi2.ppf(0.99, 3)


def test_a_claim_counts_once_as_long_as_its_probability_stays() -> None:
    path = recorded("sim1_green")
    once = calibration_of([path])
    twice = calibration_of([path, path])
    assert [2 * each.claims for kind in CLAIMS for each in once.claims[kind]] == [
        each.claims for kind in CLAIMS for each in twice.claims[kind]
    ]
    tables = [each for each in once.claims["exists"] if each.claims]
    assert sum(each.claims for each in tables) < 40  # of six objects in eleven beliefs


def test_the_tables_name_every_kind_with_claims_and_none_without(tmp_path: Path) -> None:
    found = Calibration()
    found.claim("Den", 0.95, True)
    found.error("base", (0.1,), np.array([[0.01]]))
    text = "\n".join(calibration_tables(found))
    assert "| Den | 1 | 0.050 | 0.9 to 1.0: 1.00 (0.21 to 1.00), of 1 |" in text
    assert "| base | 1 | 1.00 | 0.00 to 5.02 |" in text
    assert "ExistsIn" not in text
    assert math.isclose(found.errors["base"].nees, 1.0)
