"""The error of detected poses: a common part by the camera's calibration, and an own part of each detection.

A rigid error of the camera frame (a shift, and a rotation about the camera) moves all detections of a look. They move
by the shift, by the error of heading times the horizontal distance, and by the tilt times the height of the camera
above the object.
"""

import math

import numpy as np

from skolem.estimation.association import Measured
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.se2 import Matrix, Vector, adjoint, inverse
from skolem.traces.messages import NoiseModel, ObjectType, Pose2


def camera_covariance(noise: NoiseModel, camera_xy: Vector, drop_m: float) -> Matrix:
    """Return the covariance of the base's pose by the camera's error, over (x, y, theta), base frame, shape (3, 3).

    Args:
        noise: Gives the sds of the camera frame's shift and rotation, each axis.
        camera_xy: Position of the camera, shape (2,), metres, base frame.
        drop_m: Height of the camera above the objects in the picture.
    """
    plane = noise.extrinsics_sd_m**2 + (noise.extrinsics_sd_rad * drop_m) ** 2
    at_base = adjoint((float(camera_xy[0]), float(camera_xy[1]), 0.0))
    return np.asarray(at_base @ np.diag([plane, plane, noise.extrinsics_sd_rad**2]) @ at_base.T)


def at_object(covariance: Matrix, base_T_object: Pose2) -> Matrix:
    """Return the covariance of an object's pose, object frame, (3, 3), that follows from one of the base's pose."""
    jacobian = adjoint(inverse(base_T_object))
    return np.asarray(jacobian @ covariance @ jacobian.T)


def own_covariance(measured: Measured, camera: Matrix, config: EstimatorConfig) -> Matrix:
    """Return the part of a detection's covariance that it does not share with the others of its look, shape (3, 3).

    The covariance of the detector is that of the whole error. In no direction is the own sd less than `fit_sd_m`.
    """
    own = measured.covariance - at_object(camera, measured.base_T_object)
    values, vectors = np.linalg.eigh(own)
    return np.asarray((vectors * np.maximum(values, config.fit_sd_m**2)) @ vectors.T)


def sighting_z_sd(noise: NoiseModel, range_m: float, config: EstimatorConfig) -> float:
    """Return the sd, in metres, of a detected height at a horizontal distance `range_m` from the camera."""
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
