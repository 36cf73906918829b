import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from kit.draws import examples
from numpy.typing import NDArray
from scipy.special import ndtr

from skolem.estimation.fluents import covariance_within, prob_in_polygon, rectangle

ANGLES = st.floats(0.0, math.pi)
SDS = st.floats(0.003, 0.5)
PLACES = st.floats(-0.6, 0.6)
DESK = (1.0, 0.6)


def ellipse(angle: float, along: float, across: float) -> NDArray[np.float64]:
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    return np.asarray(turn @ np.diag([along**2, across**2]) @ turn.T)


def by_quadrature(mean: NDArray[np.float64], cov: NDArray[np.float64], size: tuple[float, float]) -> float:
    """Integrate the exact conditional mass in y over x, by Gauss-Legendre in many small panels."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = np.linspace(-size[0] / 2, size[0] / 2, 2001)
    half = (edges[1] - edges[0]) / 2
    x = (edges[:-1, None] + half + half * nodes).ravel()
    sx = math.sqrt(cov[0, 0])
    given_x = mean[1] + cov[0, 1] / cov[0, 0] * (x - mean[0])
    sy = math.sqrt(cov[1, 1] - cov[0, 1] ** 2 / cov[0, 0])
    inside = ndtr((size[1] / 2 - given_x) / sy) - ndtr((-size[1] / 2 - given_x) / sy)
    density = np.exp(-0.5 * ((x - mean[0]) / sx) ** 2) / sx / math.sqrt(math.tau)
    return float((density * inside * half * np.tile(weights, 2000)).sum())


@examples(60)
@given(ANGLES, SDS, SDS, PLACES, PLACES)
def test_mass_in_a_rectangle_agrees_with_quadrature(angle: float, a: float, b: float, x: float, y: float) -> None:
    mean, cov = np.array([x, y]), ellipse(angle, a, b)
    assert prob_in_polygon(mean, cov, rectangle(DESK)) == pytest.approx(by_quadrature(mean, cov, DESK), abs=1e-9)


@examples(60)
@given(ANGLES, st.floats(1e-6, 0.5), st.floats(1e-6, 0.5), PLACES, PLACES, st.floats(-0.4, 0.4))
def test_halves_of_a_rectangle_share_its_mass(angle: float, a: float, b: float, x: float, y: float, cut: float) -> None:
    mean, cov, whole = np.array([x, y]), ellipse(angle, a, b), rectangle(DESK)
    left = np.array([whole[0], [cut, -0.3], [cut, 0.3], whole[3]])
    right = np.array([[cut, -0.3], whole[1], whole[2], [cut, 0.3]])
    parts = prob_in_polygon(mean, cov, left) + prob_in_polygon(mean, cov, right)
    assert parts == pytest.approx(prob_in_polygon(mean, cov, whole), abs=1e-9)


def test_mean_on_an_edge_is_half_inside_and_on_a_corner_a_quarter() -> None:
    tight = 1e-6 * np.eye(2)
    assert prob_in_polygon(np.array([0.5, 0.1]), tight, rectangle(DESK)) == pytest.approx(0.5)
    assert prob_in_polygon(np.array([0.5, 0.3]), tight, rectangle(DESK)) == pytest.approx(0.25)


def test_exact_knowledge_is_inside_or_outside() -> None:
    known = np.zeros((2, 2))
    assert prob_in_polygon(np.array([0.49, 0.0]), known, rectangle(DESK)) == pytest.approx(1.0)
    assert prob_in_polygon(np.array([0.51, 0.0]), known, rectangle(DESK)) == pytest.approx(0.0)


def test_concave_polygon_is_the_sum_of_its_parts() -> None:
    mean, cov = np.array([0.3, 0.1]), np.array([[0.01, 0.003], [0.003, 0.02]])
    ell = np.array([[0, 0], [1, 0], [1, 0.4], [0.4, 0.4], [0.4, 1], [0, 1.0]])
    low = np.array([[0, 0], [1, 0], [1, 0.4], [0, 0.4]])
    high = np.array([[0, 0.4], [0.4, 0.4], [0.4, 1], [0, 1.0]])
    parts = prob_in_polygon(mean, cov, low) + prob_in_polygon(mean, cov, high)
    assert prob_in_polygon(mean, cov, ell) == pytest.approx(parts, abs=1e-12)


def test_thin_ellipse_across_the_axes_needs_more_than_its_sds() -> None:
    """Its sds along the axes fit the bound, but its end points lie outside of it."""
    bound = np.diag([0.01, 0.01]) ** 2
    assert covariance_within(ellipse(0.0, 0.0099, 0.001), bound)
    assert covariance_within(ellipse(math.pi / 4, 0.0099, 0.001), bound)
    tilted = ellipse(math.pi / 4, 0.012, 0.001)
    assert np.sqrt(np.diag(tilted)).max() < 0.01
    assert not covariance_within(tilted, bound)


def test_covariance_lies_within_itself() -> None:
    for angle in np.linspace(0.0, math.pi, 50):
        assert covariance_within(ellipse(angle, 0.3, 1e-5), ellipse(angle, 0.3, 1e-5))
