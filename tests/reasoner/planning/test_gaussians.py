"""Gaussian fluents: the Loewner order, wrapped means, and regression through observations."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from skolem.reasoner import Normal
from skolem.reasoner.planning import gaussians
from skolem.reasoner.terms import ANY, Compound, compound, nll, parse_term

SURE = nll(0.5)


def pose(covariance: np.ndarray, mean: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Normal:
    return Normal(np.array(mean), covariance, 0.9)


def test_a_rotated_ellipse_that_sticks_out_is_not_contained_although_its_diagonal_is() -> None:
    turn = np.array([[math.cos(0.7), -math.sin(0.7), 0], [math.sin(0.7), math.cos(0.7), 0], [0, 0, 1]])
    covariance = turn @ np.diag([0.0098**2, 0.001**2, 0.01**2]) @ turn.T
    bound = parse_term("sd(8,8,any)")
    assert np.all(np.diagonal(covariance)[:2] < 0.008**2)
    assert not gaussians.holds("pose", pose(covariance), "any", bound, "any", SURE)
    assert gaussians.holds("pose", pose(covariance * 0.6), "any", bound, "any", SURE)


def test_a_covariance_is_contained_in_itself() -> None:
    assert gaussians.holds("pose", pose(np.diag([8e-3, 8e-3, 1.0]) ** 2), "any", parse_term("sd(8,8,any)"), "any", SURE)


def test_the_mixture_weight_is_part_of_the_fluent() -> None:
    small = pose(np.eye(3) * 1e-8)
    assert gaussians.holds("pose", small, "any", parse_term("sd(8,8,any)"), "any", nll(0.9))
    assert not gaussians.holds("pose", small, "any", parse_term("sd(8,8,any)"), "any", nll(0.95))


def test_the_mean_is_compared_around_the_turn_of_hue_and_heading() -> None:
    red = Normal(np.array([0.99, 0.8, 0.8]), np.eye(3) * 1e-6, 1.0)
    bounds = parse_term("v(10,800,800)"), parse_term("sd(50,50,50)"), parse_term("tol(30,50,50)")
    assert gaussians.holds("colour", red, *bounds, SURE)
    about = pose(np.eye(3) * 1e-8, (0.0, 0.0, math.pi - 0.01))
    bounds = parse_term("v(0,0,-3141)"), parse_term("sd(9,9,9)"), parse_term("tol(9,9,20)")
    assert gaussians.holds("pose", about, *bounds, SURE)


def test_a_mean_at_the_edge_of_the_tolerance_is_near_enough_and_a_covariance_a_hundredth_too_large_is_not() -> None:
    bounds = parse_term("v(500)"), parse_term("sd(9)"), parse_term("tol(250)")
    assert gaussians.holds("weight", Normal(np.array([0.25]), np.eye(1) * 1e-6, 1.0), *bounds, SURE)
    assert not gaussians.holds("weight", Normal(np.array([0.249]), np.eye(1) * 1e-6, 1.0), *bounds, SURE)
    wide = pose(np.diag([0.00808, 0.008, 1.0]) ** 2)
    assert not gaussians.holds("pose", wide, "any", parse_term("sd(8,8,any)"), "any", SURE)


@given(st.floats(0.5, 30.0), st.floats(1.0, 40.0), st.floats(-0.9, 0.9), st.integers(2, 40), st.integers(2, 40))
def test_one_observation_from_what_was_needed_before_gives_what_was_asked_to_a_thousandth(
    a_mm: float, b_mm: float, correlation: float, x_mm: int, y_mm: int
) -> None:
    sensor = np.array([[a_mm**2, correlation * a_mm * b_mm], [correlation * a_mm * b_mm, b_mm**2]]) * 1e-6
    before = gaussians.before_observation(compound("sd", x_mm, y_mm), sensor)
    information = np.linalg.inv(sensor)
    if isinstance(before, Compound):
        for axis, sd in enumerate(before.args):
            if isinstance(sd, int):
                information[axis, axis] += 1.0 / (sd / 1000.0) ** 2
    after = np.linalg.inv(information)
    slack = np.diag([((x_mm + 1) / 1000) ** 2, ((y_mm + 1) / 1000) ** 2]) - after
    assert np.linalg.eigvalsh(slack)[0] >= -1e-6 * (x_mm * y_mm) * 1e-6


@pytest.mark.parametrize(("sensor_sd", "before"), [(0.024, "sd(7)"), (0.1, "sd(6)")])
def test_small_steps_add_up_unless_very_many_were_needed(sensor_sd: float, before: str) -> None:
    """An observation that leads from .0062 to .006 is a step, one of very many is none."""
    assert gaussians.before_observation(parse_term("sd(6)"), np.array([[sensor_sd**2]])) == parse_term(before)


@pytest.mark.parametrize(("p", "used"), [(0.900, 0.700), (0.95, 0.750), (0.98, 0.780), (0.3, 0.1)])
def test_a_discrete_look_is_not_trusted_to_turn_a_belief_around(p: float, used: float) -> None:
    assert gaussians.before_reading(p, 0.95) == pytest.approx(used)


def test_a_poor_reading_needs_what_bayes_needs() -> None:
    assert gaussians.before_reading(0.9, 0.6) == pytest.approx(0.9 * 0.4 / (0.9 * 0.4 + 0.1 * 0.6))
    assert gaussians.before_reading(1.0, 0.6) == 1.0


def test_several_readings_turn_any_belief_around() -> None:
    p, readings = 0.98, 0
    while p > 0.001:
        p, readings = gaussians.before_reading(p, 0.95), readings + 1
    assert readings < 8


@given(
    st.lists(st.integers(1, 60), min_size=3, max_size=3),
    st.lists(st.floats(0.002, 0.2), min_size=3, max_size=3),
    st.lists(st.floats(0.01, 1.0), min_size=3, max_size=3),
    st.floats(-0.9, 0.9),
)
def test_no_fewer_observations_would_do(
    bounds: list[int], sensor: list[float], prior: list[float], correlation: float
) -> None:
    related = np.eye(3) + correlation * (np.eye(3, k=1) + np.eye(3, k=-1)) / 2.0
    noise, present = np.diag(sensor) @ related @ np.diag(sensor), np.diag(prior) ** 2
    bound = compound("sd", *bounds)

    def after(count: int) -> Normal:
        covariance = np.linalg.inv(np.linalg.inv(present) + count * np.linalg.inv(noise))
        return Normal(np.zeros(3), (covariance + covariance.T) / 2.0, 1.0)

    def reached(count: int, slack: float) -> bool:
        wider = Normal(np.zeros(3), after(count).covariance * slack, 1.0)
        return gaussians.holds("colour", wider, ANY, bound, ANY, SURE)

    count = gaussians.observations(bound, noise, present)
    if count is None:
        assert not reached(3 * gaussians.MOST_OBSERVATIONS, 1.0 + 1e-6)
    else:
        assert reached(count, 1.0 - 1e-6)
        assert count == 1 or not reached(count - 1, 1.0 + 1e-6)


@pytest.mark.parametrize(("sensor_sd", "count"), [(0.01, 1), (0.02, 4), (0.03, 9), (0.08, 62), (0.09, None)])
def test_observations_add_up_and_very_many_are_not_planned(sensor_sd: float, count: int | None) -> None:
    prior = np.eye(1) * 0.05**2
    assert gaussians.observations(parse_term("sd(10)"), np.array([[sensor_sd**2]]), prior) == count


def test_what_holds_already_and_what_has_no_bound_take_one_observation() -> None:
    assert gaussians.observations(parse_term("sd(10)"), np.eye(1), np.eye(1) * 0.01**2 * 0.99) == 1
    assert gaussians.observations(ANY, np.eye(1), np.eye(1)) == 1
