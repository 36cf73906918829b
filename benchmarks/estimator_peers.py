"""Two peers of the smoother on the same logs: a plain EKF, and the UKF of filterpy.

Both keep one vector (x, y, theta) of the base and of every object in the prior, world frame, and one dense covariance.
From a log they take the drives, and from each look the sightings of those objects.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter
from numpy.typing import NDArray

from skolem.estimation.events import Began, Event, Looked, Moved, Sighting
from skolem.estimation.se2 import Matrix, symmetric
from skolem.sim.robot.rotations import rotation
from skolem.traces.messages import Pose2
from skolem.traces.messages.poses import flat

Array = NDArray[np.float64]


class Estimator(Protocol):
    """The interface of every estimator in the benchmark."""

    def take(self, event: Event) -> None:
        """Take in one event after the first, which is `Began`."""

    def base(self) -> tuple[Pose2, Matrix]:
        """Return world_T_base and its covariance, base frame."""

    def relative(self, anchor: str) -> tuple[Pose2, Matrix]:
        """Return base_T_object and its covariance, object frame."""


class _Filter:
    """The common part of both filters: one vector, one covariance."""

    def __init__(self, began: Began) -> None:
        prior = began.prior
        poses = [prior.world_T_base, *(flat(item.world_T_object) for item in prior.objects)]
        sds = [(prior.base_sd_xy_m, prior.base_sd_theta_rad), *((o.sd_xy_m, o.sd_theta_rad) for o in prior.objects)]
        self.index = {item.anchor: 3 * i + 3 for i, item in enumerate(prior.objects)}
        self.mean = np.concatenate([np.array(pose) for pose in poses])
        self.covariance = np.diag(np.concatenate([(m**2, m**2, rad**2) for m, rad in sds]))

    def base(self) -> tuple[Pose2, Matrix]:
        """Return world_T_base and its covariance, base frame."""
        x, y, theta = (float(v) for v in self.mean[:3])
        into = rotation(-theta)
        return (x, y, theta), into @ self.covariance[:3, :3] @ into.T

    def relative(self, anchor: str) -> tuple[Pose2, Matrix]:
        """Return base_T_object and its covariance, object frame."""
        rows = np.r_[0:3, self.index[anchor] : self.index[anchor] + 3]
        seen, jacobian = _seen(self.mean[:3], self.mean[rows[3:]])
        into = rotation(-float(seen[2])) @ jacobian
        x, y, theta = (float(v) for v in seen)
        return (x, y, theta), into @ self.covariance[np.ix_(rows, rows)] @ into.T

    def _told(self, look: Looked) -> list[Sighting]:
        """Return the sightings of objects in the prior."""
        return [s for s in look.sightings if s.anchor in self.index]

    def _measured(self, sightings: list[Sighting], camera: Matrix) -> tuple[Array, Array]:
        """Return the sightings, shape (3k,), and their covariance: each one's own, and the camera's, common to all."""
        seen = [np.array(s.camera_T_object) for s in sightings]
        own = np.zeros((3 * len(seen), 3 * len(seen)))
        common = np.zeros((3 * len(seen), 3))
        for i, (pose, s) in enumerate(zip(seen, sightings, strict=True)):
            turn = rotation(float(pose[2]))
            own[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = turn @ symmetric(s.covariance) @ turn.T
            common[3 * i : 3 * i + 3] = np.array([[-1.0, 0.0, pose[1]], [0.0, -1.0, -pose[0]], [0.0, 0.0, -1.0]])
        return np.concatenate(seen), own + common @ camera @ common.T


class Ekf(_Filter):
    """The textbook's extended Kalman filter in NumPy."""

    def take(self, event: Event) -> None:
        """Take in one event."""
        if isinstance(event, Moved):
            self._move(event)
        elif isinstance(event, Looked) and (sightings := self._told(event)):
            self._look(sightings, symmetric(event.camera_covariance))

    def _move(self, event: Moved) -> None:
        x, y, _ = event.start_T_end
        theta = float(self.mean[2])
        c, s = np.cos(theta), np.sin(theta)
        self.mean[:3] = moved(self.mean[:3], event.start_T_end)
        jacobian = np.array([[1.0, 0.0, -s * x - c * y], [0.0, 1.0, c * x - s * y], [0.0, 0.0, 1.0]])
        self.covariance[:3] = jacobian @ self.covariance[:3]
        self.covariance[:, :3] = self.covariance[:, :3] @ jacobian.T
        self.covariance[:3, :3] += np.diag([event.sd_m**2, event.sd_m**2, event.sd_rad**2])

    def _look(self, sightings: list[Sighting], camera: Matrix) -> None:
        z, noise = self._measured(sightings, camera)
        jacobian = np.zeros((len(z), len(self.mean)))
        off = np.empty(len(z))
        for i, s in enumerate(sightings):
            at, rows = self.index[s.anchor], slice(3 * i, 3 * i + 3)
            expected, slope = _seen(self.mean[:3], self.mean[at : at + 3])
            jacobian[rows, :3], jacobian[rows, at : at + 3] = slope[:, :3], slope[:, 3:]
            off[rows] = wrapped(z[rows] - expected)
        crossed = self.covariance @ jacobian.T
        gain = np.linalg.solve(jacobian @ crossed + noise, crossed.T).T
        self.mean = wrapped(self.mean + gain @ off)
        self.covariance -= gain @ crossed.T
        self.covariance = (self.covariance + self.covariance.T) / 2.0


class Ukf(_Filter):
    """The unscented Kalman filter of filterpy, with its scaled sigma points."""

    def __init__(self, began: Began) -> None:
        super().__init__(began)
        n = len(self.mean)
        points = MerweScaledSigmaPoints(n, alpha=1.0, beta=0.0, kappa=0.0, subtract=_difference)
        self.filter = UnscentedKalmanFilter(
            dim_x=n,
            dim_z=3,
            dt=1.0,
            hx=None,
            fx=lambda state, dt, start_T_end: np.concatenate([moved(state[:3], start_T_end), state[3:]]),
            points=points,
            x_mean_fn=_mean,
            z_mean_fn=_mean,
            residual_x=_difference,
            residual_z=_difference,
        )
        self.filter.x, self.filter.P = self.mean, self.covariance

    def take(self, event: Event) -> None:
        """Take in one event."""
        if isinstance(event, Moved):
            noise = np.zeros_like(self.covariance)
            noise[:3, :3] = np.diag([event.sd_m**2, event.sd_m**2, event.sd_rad**2])
            self.filter.Q = noise
            self.filter.predict(start_T_end=event.start_T_end)
        elif isinstance(event, Looked) and (sightings := self._told(event)):
            z, noise = self._measured(sightings, symmetric(event.camera_covariance))
            places = [self.index[s.anchor] for s in sightings]
            self.filter.update(z, R=noise, hx=lambda state: _all_seen(state, places))
        self.mean, self.covariance = wrapped(self.filter.x), self.filter.P


def moved(base: Array, start_T_end: Pose2) -> Array:
    """Return the pose of a base after a drive."""
    x, y, turn = start_T_end
    c, s = np.cos(base[2]), np.sin(base[2])
    return np.array([base[0] + c * x - s * y, base[1] + s * x + c * y, base[2] + turn])


def wrapped(poses: Array) -> Array:
    """Return a vector of poses, shape (3n,), with headings in [-pi, pi)."""
    poses = poses.copy()
    poses[2::3] = (poses[2::3] + np.pi) % (2.0 * np.pi) - np.pi
    return poses


def _seen(base: Array, item: Array) -> tuple[Array, Array]:
    """Return base_T_object and its Jacobian by base and object, shape (3, 6)."""
    c, s = np.cos(base[2]), np.sin(base[2])
    dx, dy = item[0] - base[0], item[1] - base[1]
    seen = np.array([c * dx + s * dy, c * dy - s * dx, item[2] - base[2]])
    slope = [[-c, -s, seen[1], c, s, 0.0], [s, -c, -seen[0], -s, c, 0.0], [0.0, 0.0, -1.0, 0.0, 0.0, 1.0]]
    return wrapped(seen), np.array(slope)


def _all_seen(state: Array, places: Sequence[int]) -> Array:
    return np.concatenate([_seen(state[:3], state[at : at + 3])[0] for at in places])


def _difference(a: Array, b: Array) -> Array:
    return wrapped(np.atleast_1d(a - b)) if a.ndim == 1 else np.array([wrapped(row) for row in a - b])


def _mean(sigmas: Array, weights: Array) -> Array:
    """Return the weighted mean of sigma points; headings are averaged around the first one."""
    first = sigmas[0]
    return np.asarray(first + weights @ np.array([wrapped(row) for row in sigmas - first]))
