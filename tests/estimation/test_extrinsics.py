import numpy as np
import pytest
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.association import Measured
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.extrinsics import at_object, camera_covariance, expected_look, own_covariance
from skolem.estimation.se2 import between, compose, exp, inverse, log
from skolem.traces.messages import NoiseModel, ObjectType, Pose2

NOISE = NoiseModel(
    **{name: 0.01 for name in NoiseModel.model_fields} | {"found": 0.9, "type_right": 0.9, "colour_gain": 1.0}
)
CAMERA, OBJECT = np.array([-0.1, 0.05, 1.4]), np.array([0.9, 0.3, 0.7])
POSE: Pose2 = (0.9, 0.3, 0.8)


def test_covariance_of_a_rigid_error_of_the_camera_agrees_with_drawing_it() -> None:
    draws = Generator(PCG64(SeedSequence([6])))
    moved = []
    for _ in range(4000):
        turn, shift = draws.normal(size=3) * NOISE.extrinsics_sd_rad, draws.normal(size=3) * NOISE.extrinsics_sd_m
        seen = OBJECT + np.cross(turn, OBJECT - CAMERA) + shift
        x, y, theta = float(seen[0]), float(seen[1]), POSE[2] + float(turn[2])
        moved.append(log(between(POSE, (x, y, theta))))
    covariance = at_object(camera_covariance(NOISE, CAMERA[:2], float(CAMERA[2] - OBJECT[2])), POSE)
    assert np.cov(np.array(moved).T) == pytest.approx(covariance, abs=1.5e-5)


def test_common_and_own_part_of_a_detection_add_up() -> None:
    camera = camera_covariance(NOISE, CAMERA[:2], 0.7)
    own = np.diag([1e-5, 2e-5, 3.0])
    total = Measured(POSE, at_object(camera, POSE) + own)
    assert own_covariance(total, camera, EstimatorConfig()) == pytest.approx(own)


def test_detection_that_claims_less_than_the_camera_allows_keeps_a_covariance() -> None:
    camera = camera_covariance(NOISE, CAMERA[:2], 0.7)
    own = own_covariance(Measured(POSE, 1e-6 * np.eye(3)), camera, EstimatorConfig())
    assert np.linalg.eigvalsh(own)[0] == pytest.approx(EstimatorConfig().fit_sd_m ** 2)


def test_heading_of_a_cylinder_stays_unknown_after_a_look() -> None:
    can = ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.1), graspable=True)
    box = can.model_copy(update={"shape": "box"})
    for pose in (POSE, compose((0.0, 0.0, 1.0), POSE), inverse(POSE), exp(np.array(POSE))):
        assert expected_look(pose, can, NOISE, EstimatorConfig())[2, 2] > 3.0
        assert expected_look(pose, box, NOISE, EstimatorConfig())[2, 2] < 0.01
