"""How well a camera whose frame is a little off sees where things are: the error common to a look, and the rest.

A rigid error of the camera frame (shift, and rotation about the camera) moves all it sees: by the shift, by the
heading's error times the horizontal distance, and by the tilt times the height of the camera above the thing.
"""

import math

import numpy as np

from skolem.estimation.association import Measured
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.se2 import Matrix, Vector, adjoint, inverse
from skolem.traces.messages import NoiseModel, ObjectType, Pose2


def camera_covariance(noise: NoiseModel, camera_xy: Vector, drop_m: float) -> Matrix:
    """Return the covariance of the base frame as a camera has it, over (x, y, theta), shape (3, 3).

    Args:
        noise: Gives the sd of the camera frame's shift and rotation, each axis.
        camera_xy: Where the camera is, shape (2,), base frame.
        drop_m: How far below the camera the things it sees stand.
    """
    plane = noise.extrinsics_sd_m**2 + (noise.extrinsics_sd_rad * drop_m) ** 2
    at_base = adjoint((float(camera_xy[0]), float(camera_xy[1]), 0.0))
    return np.asarray(at_base @ np.diag([plane, plane, noise.extrinsics_sd_rad**2]) @ at_base.T)


def at_object(covariance: Matrix, base_T_object: Pose2) -> Matrix:
    """Return what a covariance of the base frame does to a pose seen from it, object frame."""
    jacobian = adjoint(inverse(base_T_object))
    return np.asarray(jacobian @ covariance @ jacobian.T)


def own_covariance(measured: Measured, camera: Matrix, config: EstimatorConfig) -> Matrix:
    """Return the part of a detection's covariance that it does not share with the others of its look.

    What the detector reports is the whole error; less than `fit_sd_m` in any direction is not left.
    """
    own = measured.covariance - at_object(camera, measured.base_T_object)
    values, vectors = np.linalg.eigh(own)
    return np.asarray((vectors * np.maximum(values, config.fit_sd_m**2)) @ vectors.T)


def sighting_z_sd(noise: NoiseModel, range_m: float, config: EstimatorConfig) -> float:
    """Return the sd of a detected height at a horizontal distance from the camera, metres."""
    tilt = noise.extrinsics_sd_rad * range_m
    return math.sqrt(noise.extrinsics_sd_m**2 + tilt**2 + config.fit_sd_m**2)


def expected_look(base_T_object: Pose2, kind: ObjectType, noise: NoiseModel, config: EstimatorConfig) -> Matrix:
    """Return the covariance of one detection from the typical distance, over (x, y, theta), object frame."""
    x, y, theta = base_T_object
    bearing, reach = math.atan2(y, x), config.typical_range_m
    pose = (reach * math.cos(bearing), reach * math.sin(bearing), theta)
    camera = camera_covariance(noise, np.zeros(2), config.typical_drop_m)
    sds = {
        "box": (config.fit_sd_m, config.fit_sd_rad),
        "cylinder": (config.fit_sd_m, config.unknown_heading_sd_rad),
        "table": (config.table_sd_m, config.table_sd_rad),
    }
    place, heading = sds[kind.shape]
    return at_object(camera, pose) + np.diag([place**2, place**2, heading**2])
