"""A5: the smoother of a factor graph, in place of the paper's filter, agrees with an unscented Kalman filter."""

from dataclasses import dataclass

import numpy as np
import pytest
from kit.papers import at_five_percent, can, seen_as
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Began, Looked, Moved, Sighting
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.estimation.se2 import between, compose, exp, inverse, log, upper
from skolem.traces.messages import Pose2

Array = NDArray[np.float64]
CANS: dict[str, Pose2] = {"a": (1.0, -0.3, 0.2), "b": (1.3, 0.1, -0.4), "c": (0.8, 0.5, 1.0)}
NAMES = ("a", "b", "c")


@dataclass(frozen=True)
class Noise:
    """Standard deviations, (x, y, theta): of a drive, of the camera, of a sighting, and of what is told at first."""

    moved: Array
    camera: Array
    sighted: Array
    told: Array
    base: Array


def noise(scale: float) -> Noise:
    """Return noise of the size of that in the scenarios, times `scale`."""
    triples = ((0.01, 0.01, 0.01), (0.002, 0.002, 0.002), (0.002, 0.002, 0.007), (0.02, 0.02, 0.05), (0.007,) * 3)
    return Noise(*(scale * np.array(triple) for triple in triples))


class Ukf:
    """A textbook unscented Kalman filter over (base, a, b, c) in the tangent space of the mean."""

    def __init__(self, poses: list[Pose2], covariance: Array, sds: Noise) -> None:
        self.poses, self.covariance, self.sds = poses, covariance, sds

    def _points(self, covariance: Array) -> tuple[list[list[Pose2]], Array]:
        """Return sigma points of the poses and of an additional noise: states and noise vectors, shape (2n, k)."""
        k = len(covariance)
        joint = np.block([[self.covariance, np.zeros((12, k))], [np.zeros((k, 12)), covariance]])
        root = np.linalg.cholesky(joint * len(joint))
        offsets = np.vstack([root.T, -root.T])
        states = [[compose(p, exp(o[3 * i : 3 * i + 3])) for i, p in enumerate(self.poses)] for o in offsets]
        return states, offsets[:, 12:]

    def _settle(self, states: list[list[Pose2]]) -> Array:
        """Take the mean and covariance of sigma points; return their tangents at the mean, shape (2n, 12)."""
        for _ in range(10):
            tangents = np.array([np.concatenate(list(map(self._at, range(4), s))) for s in states])
            mean = tangents.mean(axis=0)
            self.poses = [compose(p, exp(mean[3 * i : 3 * i + 3])) for i, p in enumerate(self.poses)]
        self.covariance = tangents.T @ tangents / len(tangents)
        return tangents

    def _at(self, i: int, pose: Pose2) -> Array:
        return log(between(self.poses[i], pose))

    def move(self, start_T_end: Pose2) -> None:
        states, draws = self._points(np.diag(self.sds.moved**2))
        self.poses[0] = compose(self.poses[0], start_T_end)
        moved = [[compose(compose(s[0], start_T_end), exp(w)), *s[1:]] for s, w in zip(states, draws, strict=True)]
        self._settle(moved)

    def look(self, seen: dict[str, Pose2]) -> None:
        states, draws = self._points(np.diag(self.sds.camera**2))
        cameras = [compose(s[0], exp(e)) for s, e in zip(states, draws, strict=True)]
        off = np.array(
            [
                np.concatenate([log(between(z, between(c, s[1 + NAMES.index(n)]))) for n, z in seen.items()])
                for s, c in zip(states, cameras, strict=True)
            ]
        )
        tangents = np.array([np.concatenate(list(map(self._at, range(4), s))) for s in states])
        mean, spread = off.mean(axis=0), off - off.mean(axis=0)
        innovation = spread.T @ spread / len(off) + np.kron(np.eye(len(seen)), np.diag(self.sds.sighted**2))
        gain = np.linalg.solve(innovation, spread.T @ tangents / len(off)).T
        step = -gain @ mean
        self.poses = [compose(p, exp(step[3 * i : 3 * i + 3])) for i, p in enumerate(self.poses)]
        self.covariance = self.covariance - gain @ innovation @ gain.T


def looked(seen: dict[str, Pose2], sds: Noise) -> Looked:
    """Return a look as the estimator logs it."""
    shown = seen_as((1.0, 0.0, 0.7, 0.0))
    sightings = tuple(
        Sighting(
            anchor=n,
            new=False,
            camera_T_object=z,
            covariance=upper(np.diag(sds.sighted**2)),
            z=0.7,
            z_sd_m=0.01,
            odds=10.0,
            detection=shown,
        )
        for n, z in seen.items()
    )
    return Looked(camera_covariance=upper(np.diag(sds.camera**2)), sightings=sightings, missed=())


def both(seed: int, sds: Noise) -> tuple[PoseGraph, Ukf]:
    """Feed one log of drives and looks at three objects to both."""
    objects = tuple(
        can(n, 1.0, (x, y, 0.7, t), sds.told[0]).model_copy(update={"sd_theta_rad": sds.told[2]})
        for n, (x, y, t) in CANS.items()
    )
    base_sds = {"base_sd_xy_m": sds.base[0], "base_sd_theta_rad": sds.base[2]}
    graph = PoseGraph(EstimatorConfig())
    graph.apply(Began(prior=at_five_percent().model_copy(update={"objects": objects, "regions": ()} | base_sds)))
    start = np.concatenate([sds.base, *[sds.told] * 3])
    ukf = Ukf([(0.0, 0.0, 0.0), *CANS.values()], np.diag(start**2), sds)
    draws = Generator(PCG64(SeedSequence([seed])))

    def erring(pose: Pose2, sd: Array) -> Pose2:
        return compose(pose, exp(draws.normal(size=3) * sd))

    truth = {n: erring(p, sds.told) for n, p in CANS.items()}
    base = erring((0.0, 0.0, 0.0), sds.base)
    for step in range(6):
        motion = exp(draws.normal(size=3) * 0.3)
        base = erring(compose(base, motion), sds.moved)
        graph.apply(Moved(start_T_end=motion, sd_m=sds.moved[0], sd_rad=sds.moved[2]))
        ukf.move(motion)
        camera = erring(base, sds.camera)
        seen = {n: erring(between(camera, truth[n]), sds.sighted) for n in NAMES[: 1 + step % 3]}
        graph.apply(looked(seen, sds))
        ukf.look(seen)
    return graph, ukf


@pytest.mark.parametrize(("scale", "of_sd", "of_spread"), [(1.0, 0.25, 0.05), (0.3, 0.1, 0.02)])
@pytest.mark.parametrize("seed", range(4))
def test_marginals_agree_with_those_of_an_unscented_kalman_filter(
    seed: int, scale: float, of_sd: float, of_spread: float
) -> None:
    """ "Updated using a variant of the unscented Kalman filter."

    Means agree to a share of their sd, sds and correlations to a share of themselves, and both the better the smaller
    the noise is: what is left is that a filter keeps the points around which it linearised, and a smoother does not.
    """
    graph, ukf = both(seed, noise(scale))
    joint = graph.joint((BASE, *NAMES))
    sds = np.sqrt(np.diag(ukf.covariance))
    for i, pose in enumerate(joint.world_T_body):
        off = log(compose(inverse(ukf.poses[i]), pose)) / sds[3 * i : 3 * i + 3]
        assert np.abs(off).max() < of_sd
    own = np.sqrt(np.diag(joint.covariance))
    assert own == pytest.approx(sds, rel=of_spread)
    assert np.abs(joint.covariance / np.outer(own, own) - ukf.covariance / np.outer(sds, sds)).max() < of_spread
