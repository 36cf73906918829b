"""B2: B(phi, mu, Sigma, Delta, p): close in mean, at least as certain, with enough mixture weight."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from kit.papers import Handler, at_five_percent, can, posed
from numpy.typing import NDArray

from skolem.estimation.fluents import covariance_within
from skolem.reasoner import Normal
from skolem.reasoner.planning import gaussians
from skolem.reasoner.terms import compound, nll, parse_term

Array = NDArray[np.float64]
SURE = nll(0.5)
BOUND = np.diag([8e-3, 8e-3]) ** 2


def ellipse(long_m: float, short_m: float, turn: float) -> Array:
    """Return a covariance with these sds along axes that are turned."""
    c, s = math.cos(turn), math.sin(turn)
    rotation = np.array([[c, -s], [s, c]])
    return np.asarray(rotation @ np.diag([long_m, short_m]) ** 2 @ rotation.T)


def contained(covariance: Array) -> bool:
    """Ask the fluent whether the covariance of a pose is at most 8 mm each way."""
    whole = np.eye(3)
    whole[:2, :2] = covariance
    belief = Normal(np.zeros(3), whole, 0.9)
    return gaussians.holds("pose", belief, "any", parse_term("sd(8,8,any)"), "any", SURE)


def test_a_turned_ellipse_that_sticks_out_is_not_contained_although_its_diagonal_is_smaller() -> None:
    """ "The equi-probability contour of Sigma_1 is contained in the equi-probability contour of Sigma_2." """
    sticks_out = ellipse(0.0098, 0.001, 0.7)
    assert (np.diag(sticks_out) < np.diag(BOUND)).all()
    assert not contained(sticks_out)
    assert not covariance_within(sticks_out, BOUND)
    assert contained(ellipse(0.0079, 0.001, 0.7))


@given(st.floats(1e-3, 0.012), st.floats(1e-3, 0.012), st.floats(0.0, math.pi))
def test_containment_is_that_of_the_contours(a: float, b: float, turn: float) -> None:
    """ "For any fixed probability": every point of the one contour lies inside the other."""
    covariance = ellipse(a, b, turn)
    angles = np.linspace(0.0, math.tau, 720)
    contour = np.linalg.cholesky(covariance) @ np.stack([np.cos(angles), np.sin(angles)])
    outermost = float(np.max(np.hypot(*contour)) / 0.008)
    if abs(outermost - 1.0) > 1e-3:
        assert contained(covariance) is covariance_within(covariance, BOUND) is (outermost < 1.0)


def test_the_mean_must_be_within_delta() -> None:
    """ "|mu - M_b| <= Delta." """
    belief = Normal(np.array([math.log(0.5)]), np.array([[0.01]]), 0.9)
    mu = compound("v", round(1000 * math.log(0.5)) + 50)
    for reach, expected in ((51, True), (49, False)):
        fluent = mu, parse_term("sd(100)"), compound("tol", reach)
        assert gaussians.holds("weight", belief, *fluent, SURE) is expected


@pytest.mark.parametrize(("p", "expected"), [(0.5, True), (0.9, True), (0.91, False)])
def test_the_mixture_weight_must_be_at_least_p(p: float, expected: bool) -> None:
    """ "That has mixture weight P_b": printed "p >= P_b", read as the prose has it, "at least as certain"."""
    belief = Normal(np.array([math.log(0.5)]), np.array([[0.01]]), 0.9)
    assert gaussians.holds("weight", belief, "any", parse_term("sd(200)"), "any", nll(p)) is expected


def test_a_goal_states_it_in_the_notation_of_the_paper() -> None:
    """ "B(phi, mu, Sigma, Delta, p)." """
    robot = Handler(at_five_percent([can()]))
    goal = "B(Weight(can1), -0.693, 0.2, 0.1, 0.9)"
    assert posed(goal, robot.belief).achieved() is None
    robot.pick("can1")
    robot.weigh(0.5)
    assert posed(goal, robot.belief).achieved() is not None
    assert posed("B(Weight(can1), -1.2, 0.2, 0.1, 0.9)", robot.belief).achieved() is None
