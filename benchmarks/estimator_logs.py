"""Logs of a robot that drives round a ring of objects, with the truth; errors are drawn from the estimator's models."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from skolem.estimation.events import Began, Looked, Moved, Sighting
from skolem.estimation.se2 import between, compose, exp, upper
from skolem.traces.messages import (
    Detection,
    HsvBelief,
    NoiseModel,
    ObjectType,
    Pose2,
    Prior,
    PriorObject,
    RobotState,
)

Array = NDArray[np.float64]
STEP_M = 0.3  # of a drive
SIGHT_M, SIGHT_RAD, MOST_SEEN = 2.5, math.pi / 4.0, 6
MOVED_SDS = np.array([0.01, 0.01, 0.015])  # x, y, theta
CAMERA_SDS = np.array([0.01, 0.01, 0.01])  # common to what one look shows
SIGHTED_SDS = np.array([0.005, 0.005, 0.03])
TOLD_SDS = np.array([0.1, 0.1, 0.2])  # of each object before the first look
BASE_SDS = np.array([0.01, 0.01, 0.01])
NOWHERE = Detection(
    base_T_object=(0.0, 0.0, 0.0, 0.0),
    covariance=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0),
    type_log_likelihood={"box": 0.0},
    rgb=(0.5, 0.5, 0.5),
    points=1,
)


@dataclass(frozen=True, slots=True)
class Step:
    """One drive and the look after it: what was told to the estimator, and the truth."""

    moved: Moved
    looked: Looked
    world_T_base: Pose2


@dataclass(frozen=True, slots=True)
class Log:
    """A run: what is told, the true places of the objects, and the steps."""

    began: Began
    world_T_object: dict[str, Pose2]
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Course:
    """A run without an end: what is told, the true places of the objects, and the steps, each made when asked for."""

    began: Began
    world_T_object: dict[str, Pose2]
    steps: Iterator[Step]


def simulated(objects: int, steps: int, seed: int, base_heading_sd: float = float(BASE_SDS[2])) -> Log:
    """Return the first steps of a course."""
    run = course(objects, seed, base_heading_sd)
    return Log(run.began, run.world_T_object, tuple(itertools.islice(run.steps, steps)))


def steps_a_round(objects: int) -> int:
    """Return how many drives it takes to come round the ring of so many objects."""
    return math.ceil(math.tau * _radius(objects) / STEP_M)


def course(objects: int, seed: int, base_heading_sd: float = float(BASE_SDS[2])) -> Course:
    """Return a run round a ring whose length grows with the number of objects, round after round.

    Args:
        objects: How many.
        seed: Of every draw.
        base_heading_sd: How well the heading of the base is known at first, rad.
    """
    draws = Generator(PCG64(SeedSequence([seed, objects])))
    radius = _radius(objects)
    names = tuple(f"object{i}" for i in range(objects))
    angles, reach = draws.uniform(0.0, math.tau, objects), radius + draws.uniform(0.5, 1.5, objects)
    headings = draws.uniform(-math.pi, math.pi, objects)
    truth = np.stack([reach * np.cos(angles), reach * np.sin(angles), headings], axis=1)
    world_T_object = {name: (float(x), float(y), float(t)) for name, (x, y, t) in zip(names, truth, strict=True)}
    base: Pose2 = (radius, 0.0, 0.0)
    base_sds = np.array([*BASE_SDS[:2], base_heading_sd])
    began = _began(
        erring(base, base_sds, draws), {n: erring(p, TOLD_SDS, draws) for n, p in world_T_object.items()}, base_sds
    )
    return Course(began, world_T_object, _driven(base, radius, truth, names, draws))


def _driven(base: Pose2, radius: float, truth: Array, names: tuple[str, ...], draws: Generator) -> Iterator[Step]:
    """Yield drives along the ring, each with a look, from where the base is."""
    for step in itertools.count(1):
        wanted = _on_ring(radius, step)
        by_wheels = between(base, wanted)
        base = erring(wanted, MOVED_SDS, draws)
        moved = Moved(start_T_end=by_wheels, sd_m=float(MOVED_SDS[0]), sd_rad=float(MOVED_SDS[2]))
        yield Step(moved, _look(base, truth, names, draws), base)


def _radius(objects: int) -> float:
    return max(1.5, objects / 10.0)


def erring(pose: Pose2, sds: Array, draws: Generator) -> Pose2:
    """Return a pose off by an error in its own frame."""
    return compose(pose, exp(draws.normal(size=3) * sds))


def _on_ring(radius: float, step: int) -> Pose2:
    angle = STEP_M / radius * step
    return (radius * math.cos(angle), radius * math.sin(angle), angle + 0.3 * math.sin(step / 7.0))


def _look(base: Pose2, truth: Array, names: tuple[str, ...], draws: Generator) -> Looked:
    """Return a look at the nearest things in view; cameras err once per look, sightings each."""
    camera = erring(base, CAMERA_SDS, draws)
    apart = truth[:, :2] - camera[:2]
    distance = np.hypot(apart[:, 0], apart[:, 1])
    bearing = np.abs((np.arctan2(apart[:, 1], apart[:, 0]) - camera[2] + math.pi) % math.tau - math.pi)
    seen = np.flatnonzero((distance < SIGHT_M) & (bearing < SIGHT_RAD))
    nearest = seen[np.argsort(distance[seen], kind="stable")][:MOST_SEEN]
    sightings = []
    for i in sorted(int(i) for i in nearest):
        x, y, theta = (float(value) for value in truth[i])
        sightings.append(sighting(names[i], erring(between(camera, (x, y, theta)), SIGHTED_SDS, draws), SIGHTED_SDS))
    return Looked(camera_covariance=upper(np.diag(CAMERA_SDS**2)), sightings=tuple(sightings), missed=())


def sighting(name: str, camera_T_object: Pose2, sds: Array) -> Sighting:
    """Return a sighting as the estimator logs it."""
    return Sighting(
        anchor=name,
        new=False,
        camera_T_object=camera_T_object,
        covariance=upper(np.diag(sds**2)),
        z=0.0,
        z_sd_m=0.01,
        odds=10.0,
        detection=NOWHERE,
    )


def _began(base: Pose2, objects: dict[str, Pose2], base_sds: Array) -> Began:
    """Return what is told: types, colours and weights play no part here."""
    told = tuple(
        PriorObject(
            anchor=name,
            type={"box": 1.0},
            world_T_object=(x, y, 0.0, theta),
            sd_xy_m=float(TOLD_SDS[0]),
            sd_theta_rad=float(TOLD_SDS[2]),
        )
        for name, (x, y, theta) in objects.items()
    )
    rates = {"found": 0.9, "type_right": 0.9, "colour_gain": 1.0}
    prior = Prior(
        world_T_base=base,
        base_sd_xy_m=float(base_sds[0]),
        base_sd_theta_rad=float(base_sds[2]),
        robot=RobotState(right_arm=(0.0,) * 7, left_arm=(0.0,) * 7),
        objects=told,
        types={"box": ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True)},
        colour=HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.1, 0.1, 0.1)),
        log_weight=(0.0, 1.0),
        noise=NoiseModel(**{name: 0.0 for name in NoiseModel.model_fields} | rates),
    )
    return Began(prior=prior)
