"""The rendered Kinect on the head: colour and exact depth."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.robot.bullet import p
from skolem.sim.space.pinhole import COLUMNS, FOVY_RAD, ROWS, Frame

NEAR_M, FAR_M = 0.3, 5.0
RENDERER_GAIN = 0.80  # measured mean rendered value of an object divided by the value of its paint, due to shading


@dataclass(frozen=True, slots=True)
class Image:
    """One rendered picture.

    Attributes:
        rgb: Shape (rows, columns, 3), uint8.
        depth: Depth along the camera's axis, shape (rows, columns), metres; `FAR_M` where nothing is hit.
        body: PyBullet's body in each pixel, shape (rows, columns); for tests, never for the robot.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float64]
    body: NDArray[np.int64]


def render(
    client: int,
    world_T_camera: Frame,
    columns: int = COLUMNS,
    rows: int = ROWS,
    light_world: tuple[float, float, float] | None = None,
) -> Image:
    """Return the picture of a camera whose x axis looks forward, z up; no graphics hardware is needed.

    Args:
        client: Physics client.
        world_T_camera: Frame of the camera.
        columns: Width of the picture in pixels.
        rows: Height of the picture in pixels.
        light_world: Direction towards the light; None: the renderer's own, from above.
    """
    eye, forward, up = world_T_camera.origin, world_T_camera.axes[:, 0], world_T_camera.axes[:, 2]
    view = p.computeViewMatrix(eye.tolist(), (eye + forward).tolist(), up.tolist())
    projection = p.computeProjectionMatrixFOV(math.degrees(FOVY_RAD), columns / rows, NEAR_M, FAR_M)
    light = {} if light_world is None else {"lightDirection": light_world}
    _, _, rgba, buffer, body = p.getCameraImage(
        columns, rows, view, projection, shadow=0, renderer=p.ER_TINY_RENDERER, physicsClientId=client, **light
    )
    # asarray and reshape: builds of PyBullet without NumPy return flat tuples
    colour = np.asarray(rgba, dtype=np.uint8).reshape(rows, columns, 4)[:, :, :3]
    z = np.asarray(buffer, dtype=np.float64).reshape(rows, columns)
    depth = FAR_M * NEAR_M / (FAR_M - (FAR_M - NEAR_M) * z)
    return Image(np.ascontiguousarray(colour), depth, np.asarray(body, dtype=np.int64).reshape(rows, columns))


def exposed(rgb: NDArray[np.uint8], colour_gain: float) -> NDArray[np.float64]:
    """Return a picture, each 0..1, scaled so that the mean value of an object is `colour_gain` times its paint's."""
    return np.minimum(rgb / 255.0 * (colour_gain / RENDERER_GAIN), 1.0)
