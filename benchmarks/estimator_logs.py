"""Logs, with the truth, of a robot that drives round a ring of objects; the estimator's models give the errors."""

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
STEP_M = 0.3  # length of a drive
SIGHT_M, SIGHT_RAD, MOST_SEEN = 2.5, math.pi / 4.0, 6
MOVED_SDS = np.array([0.01, 0.01, 0.015])  # x, y, theta
CAMERA_SDS = np.array([0.01, 0.01, 0.01])  # common to all sightings of one look
SIGHTED_SDS = np.array([0.005, 0.005, 0.03])
TOLD_SDS = np.array([0.1, 0.1, 0.2])  # prior of each object before the first look
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
    """One drive and the look after it: the estimator's inputs, and the truth."""

    moved: Moved
    looked: Looked
    world_T_base: Pose2


@dataclass(frozen=True, slots=True)
class Log:
    """A run: the prior, the true poses of the objects, and the steps."""

    began: Began
    world_T_object: dict[str, Pose2]
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Course:
    """An endless run: the prior, the true poses of the objects, and the steps, which are made on demand."""

    began: Began
    world_T_object: dict[str, Pose2]
    steps: Iterator[Step]


def simulated(objects: int, steps: int, seed: int, base_heading_sd: float = float(BASE_SDS[2])) -> Log:
    """Return the first steps of a course."""
    run = course(objects, seed, base_heading_sd)
    return Log(run.began, run.world_T_object, tuple(itertools.islice(run.steps, steps)))


def steps_a_round(objects: int) -> int:
    """Return the number of drives once round the ring of so many objects."""
    return math.ceil(math.tau * _radius(objects) / STEP_M)


def course(objects: int, seed: int, base_heading_sd: float = float(BASE_SDS[2])) -> Course:
    """Return an endless run round a ring whose length grows with the number of objects.

    Args:
        objects: Number of objects.
        seed: Seed of every random draw.
        base_heading_sd: Standard deviation of the heading of the base at the start, rad.
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
    """Yield drives along the ring from the pose `base`, each with a look."""
    for step in itertools.count(1):
        wanted = _on_ring(radius, step)
        by_wheels = between(base, wanted)
        base = erring(wanted, MOVED_SDS, draws)
        moved = Moved(start_T_end=by_wheels, sd_m=float(MOVED_SDS[0]), sd_rad=float(MOVED_SDS[2]))
        yield Step(moved, _look(base, truth, names, draws), base)


def _radius(objects: int) -> float:
    return max(1.5, objects / 10.0)


def erring(pose: Pose2, sds: Array, draws: Generator) -> Pose2:
    """Return a pose with a drawn error in its own frame."""
    return compose(pose, exp(draws.normal(size=3) * sds))


def _on_ring(radius: float, step: int) -> Pose2:
    angle = STEP_M / radius * step
    return (radius * math.cos(angle), radius * math.sin(angle), angle + 0.3 * math.sin(step / 7.0))


def _look(base: Pose2, truth: Array, names: tuple[str, ...], draws: Generator) -> Looked:
    """Return a look at the nearest objects in view, with one error of the camera and one of each sighting."""
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
    """Return a sighting in the form of the estimator's log."""
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
    """Return the prior, in which types, colours and weights do not matter."""
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
