"""Errors of the simulated sensors and wheels: keyed random streams, the draws, and their covariances.

All errors are drawn from the `NoiseModel` of the true world. Each consumer has a stream of its own, so that a new
consumer, or one that draws more, shifts no other draw.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from skolem.traces.messages import NoiseModel, Pose2
from skolem.traces.messages.poses import wrap_half_open

# Kinect v1: axial noise after Nguyen, Izadi and Lovell, "Modeling Kinect sensor noise" (2012)
AXIAL_SD_M, AXIAL_SD_PER_M2, AXIAL_BEST_M = 0.0012, 0.0019, 0.4
FOCAL_TIMES_BASELINE = 575.8 * 0.075  # pixels times metres
DISPARITY_STEPS_PER_PIXEL = 8.0
EDGE_JUMP_M = 0.06  # depth steps between neighbours above this are edges of the scene
EDGE_LOSS = 0.5  # probability that a pixel on an edge returns nothing
RANGE_M = (0.5, 4.5)  # outside of this the sensor returns nothing


class Purpose(IntEnum):
    """The purpose of a random stream; numbers are part of the trace contract and are never reused."""

    DEPTH = 1
    EXTRINSICS = 2
    COLOUR = 3
    MISSED = 4
    CONFUSED = 5
    FALSE_ALARM = 6
    ODOMETRY = 7
    WRIST = 8
    WRIST_BIAS = 9
    TABLES = 10


def stream(seed: int, step: int, purpose: Purpose) -> Generator:
    """Return the generator of one purpose at one step of a run; equal keys give equal draws."""
    return Generator(PCG64(SeedSequence([seed, step, int(purpose)])))


@dataclass(frozen=True, slots=True)
class Extrinsics:
    """A rigid error of the camera frame: believed point = turn @ point + shift, camera frame.

    Attributes:
        turn: Rotation matrix, shape (3, 3).
        shift: Shape (3,), metres.
    """

    turn: NDArray[np.float64]
    shift: NDArray[np.float64]


def axial_sd(depth: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sd of a depth reading, metres, of the same shape as `depth` (metres)."""
    return np.asarray(AXIAL_SD_M + AXIAL_SD_PER_M2 * (depth - AXIAL_BEST_M) ** 2)


def noisy_depth(depth: NDArray[np.float64], scale: float, draws: Generator) -> NDArray[np.float64]:
    """Return the noisy readings of a depth image.

    Args:
        depth: Exact distance along the camera's axis, shape (rows, columns), metres.
        scale: Factor on the axial sd; with 0 the depth is exact, neither stepped nor lost at edges.
        draws: Generator of this look.

    Returns:
        Shape (rows, columns), metres; NaN where there is no reading.
    """
    reported = depth.copy()
    if scale > 0.0:
        reported += draws.normal(size=depth.shape) * scale * axial_sd(depth)
        steps = DISPARITY_STEPS_PER_PIXEL * FOCAL_TIMES_BASELINE
        reported = steps / np.round(steps / reported)
        across, along = np.gradient(depth)
        reported[(np.hypot(across, along) > EDGE_JUMP_M) & (draws.random(depth.shape) < EDGE_LOSS)] = np.nan
    reported[(depth < RANGE_M[0]) | (depth > RANGE_M[1])] = np.nan
    return reported


def extrinsic_error(noise: NoiseModel, draws: Generator) -> Extrinsics:
    """Draw the calibration error of one look."""
    turn = scipy.spatial.transform.Rotation.from_rotvec(draws.normal(size=3) * noise.extrinsics_sd_rad).as_matrix()
    return Extrinsics(turn, draws.normal(size=3) * noise.extrinsics_sd_m)


def extrinsic_covariance(noise: NoiseModel, camera_to_object: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the covariance of the calibration error in the seen pose of an object.

    To first order the object moves by `shift + rotvec x r`, and turns by the rotation vector's z component.

    Args:
        noise: Gives the sd of shift and rotation vector, equal on all axes, so any frame's axes serve.
        camera_to_object: r, from the camera to the object, shape (3,), metres, axes with z up.

    Returns:
        Shape (3, 3), over (x, y, theta) along the axes of `camera_to_object`.
    """
    x, y, z = camera_to_object
    levers = np.array([[0.0, z, -y], [-z, 0.0, x], [0.0, 0.0, 1.0]])  # d(x, y, theta) / d(rotation vector)
    shift = np.diag([1.0, 1.0, 0.0])
    return np.asarray(noise.extrinsics_sd_m**2 * shift + noise.extrinsics_sd_rad**2 * levers @ levers.T)


def odometry_error(noise: NoiseModel, start_T_end: Pose2, draws: Generator) -> Pose2:
    """Draw end_T_true: the true pose after a drive commanded to `start_T_end`, in the frame of the commanded end."""
    distance, turn = float(np.hypot(start_T_end[0], start_T_end[1])), abs(wrap_half_open(start_T_end[2]))
    sd_m = noise.odometry_sd_m + noise.odometry_sd_per_m * distance
    sd_rad = noise.odometry_sd_rad + noise.odometry_sd_per_rad * turn
    x, y, theta = draws.normal(size=3) * (sd_m, sd_m, sd_rad)
    return (float(x), float(y), float(theta))


def wrist_error(noise: NoiseModel, seed: int, step: int) -> NDArray[np.float64]:
    """Draw the error of one averaged force reading, shape (3,), newtons: the bias of the run plus noise of the step."""
    bias = stream(seed, 0, Purpose.WRIST_BIAS).normal(size=3) * noise.wrist_drift_newton
    reading = stream(seed, step, Purpose.WRIST).normal(size=3) * noise.wrist_sd_newton
    return np.asarray(bias + reading)
