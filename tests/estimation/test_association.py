import math

import numpy as np
import pytest
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.association import Measured, assign, match, with_heading_near
from skolem.estimation.se2 import compose, exp, turned
from skolem.traces.messages import ObjectType

CAN = ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.1), graspable=True)
BOX = ObjectType(shape="box", size_m=(0.06, 0.09, 0.1), graspable=True)
SQUARE = ObjectType(shape="box", size_m=(0.06, 0.06, 0.1), graspable=True)
COVARIANCE = np.diag([1e-4, 4e-4, 9e-4])
UNMATCHED = np.array([-3.0])


def test_distance_of_a_detection_is_in_sds_of_belief_and_sensor_together() -> None:
    found = match((1.0, 0.0, math.pi / 2), COVARIANCE, Measured((1.0, 0.03, math.pi / 2), COVARIANCE))
    assert found.distance2 == pytest.approx(0.03**2 / 2e-4)
    spread = 2.0 * COVARIANCE
    assert found.log_density == pytest.approx(-0.5 * (found.distance2 + math.log(np.linalg.det(math.tau * spread))))


def test_squared_distances_of_true_pairs_follow_chi_square() -> None:
    draws = Generator(PCG64(SeedSequence([4])))
    distances = []
    for _ in range(2000):
        truth = exp(draws.normal(size=3))
        believed = compose(truth, exp(draws.normal(size=3) * np.sqrt(np.diag(COVARIANCE))))
        seen = compose(truth, exp(draws.normal(size=3) * np.sqrt(np.diag(COVARIANCE))))
        distances.append(match(believed, COVARIANCE, Measured(seen, COVARIANCE)).distance2)
    assert np.mean(distances) == pytest.approx(3.0, abs=0.2)
    assert np.mean(np.array(distances) > 16.266) < 0.004


@pytest.mark.parametrize(
    ("kind", "heading"), [(CAN, 2.0), (BOX, 0.2 + math.pi), (SQUARE, 0.2 + math.pi / 2)], ids=["can", "box", "square"]
)
def test_heading_is_read_as_the_nearest_that_looks_alike(kind: ObjectType, heading: float) -> None:
    seen = with_heading_near(Measured((1.0, 2.0, 0.2), COVARIANCE), 2.0 if kind is not BOX else 3.0, kind, kind, 1.8)
    assert seen.base_T_object[:2] == pytest.approx((1.0, 2.0))
    assert math.remainder(seen.base_T_object[2] - heading, math.tau) == pytest.approx(0.0, abs=1e-12)
    assert turned(seen.covariance, seen.base_T_object[2]) == pytest.approx(turned(COVARIANCE, 0.2))


@pytest.mark.parametrize("believed", [CAN, SQUARE])
def test_heading_of_what_is_believed_to_be_of_another_type_is_not_measured(believed: ObjectType) -> None:
    seen = with_heading_near(Measured((1.0, 2.0, 0.2), COVARIANCE), 2.0, believed, BOX, 1.8)
    assert seen.covariance[2, 2] == pytest.approx(COVARIANCE[2, 2] + 1.8**2)
    assert np.linalg.eigvalsh(seen.covariance)[0] > 0.0


def test_assignment_maximises_the_whole_look_not_each_detection() -> None:
    scores = np.array([[5.0, 4.0], [4.9, -math.inf]])
    assert assign(scores, unmatched=UNMATCHED) == (1, 0)


def test_detection_outside_every_gate_is_new() -> None:
    assert assign(np.array([[-math.inf, -math.inf], [3.0, 1.0]]), unmatched=UNMATCHED) == (None, 0)


def test_two_detections_of_one_object_are_not_both_its_own() -> None:
    assert assign(np.array([[5.0], [4.0]]), unmatched=UNMATCHED) == (0, None)


def test_pair_less_likely_than_a_new_object_is_not_made() -> None:
    assert assign(np.array([[-4.0]]), unmatched=UNMATCHED) == (None,)


def test_what_speaks_for_a_new_object_may_differ_between_detections() -> None:
    assert assign(np.array([[-4.0, -math.inf], [-math.inf, -4.0]]), unmatched=np.array([-3.0, -5.0])) == (None, 1)


@pytest.mark.parametrize("shape", [(0, 3), (0, 0), (2, 0)])
def test_looks_without_detections_or_anchors_are_assigned(shape: tuple[int, int]) -> None:
    assert assign(np.zeros(shape), unmatched=np.full(shape[0], -3.0)) == (None,) * shape[0]
