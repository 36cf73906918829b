"""Gross errors of the detector: far-off places, and things that are not there, one in ten each."""

import math

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray
from test_belief import FIT_SD, NOISE, Robot, depth_view, detection, prior

from skolem.estimation.se2 import between, compose, exp
from skolem.traces.messages import Pose2

CANS = {f"can{i}": (0.75 + 0.15 * (i % 2), -0.4 + 0.2 * i, 0.0) for i in range(5)}
SHARE = 0.1  # of outliers, and of false detections
NEAR_M = 0.05
LOOKS, CALM, SEEDS = 12, 2, 1  # the last looks without gross errors: what is there must be listed again


def run(seed: int, outliers: float, false: float) -> tuple[Robot, dict[str, Pose2], list[float]]:
    """Return the robot after its looks, where the cans are relative to it, and all squared errors of places."""
    draws, gross = Generator(PCG64(SeedSequence([seed]))), Generator(PCG64(SeedSequence([seed, 1])))
    noise = NOISE.model_copy(update={"false_per_look": max(false * len(CANS), 0.05)})
    robot, base = Robot(prior(CANS, noise=noise, sd_m=0.03)), exp(draws.normal(size=3) * 0.01)
    truth = {name: compose(p, exp(draws.normal(size=3) * (0.03, 0.03, 0.0))) for name, p in CANS.items()}
    squares = []
    for step in range(LOOKS + CALM):
        outliers, false = (outliers, false) if step < LOOKS else (0.0, 0.0)
        if step % 4 == 3:
            motion = exp(draws.uniform(-0.05, 0.05, 3))
            base = compose(compose(base, motion), exp(draws.normal(size=3) * (0.006, 0.006, 0.011)))
            robot.drive(motion)
        camera = exp(draws.normal(size=3) * (0.005, 0.005, 0.005))
        here = {name: between(base, can) for name, can in truth.items()}
        seen = [compose(compose(camera, p), exp(draws.normal(size=3) * (FIT_SD, FIT_SD, 0.0))) for p in here.values()]
        shown = [(x + far(gross), y + far(gross), t) if gross.random() < outliers else (x, y, t) for x, y, t in seen]
        kept = [pose for pose, luck in zip(shown, draws.random(len(shown)), strict=True) if luck < NOISE.found]
        kept += [(gross.uniform(0.7, 1.2), gross.uniform(-0.5, 0.5), 0.0) for _ in range(gross.poisson(false * 5))]
        robot.look([detection(pose) for pose in kept], depth_view(here.values()))
        squares += [off_m(robot, name, pose) ** 2 for name, pose in here.items()]
    return robot, {name: between(base, can) for name, can in truth.items()}, squares


def far(draws: Generator) -> float:
    """Return a gross error of a coordinate, metres: to either side, 8 to 40 cm."""
    return math.copysign(float(draws.uniform(0.08, 0.4)), float(draws.uniform(-1.0, 1.0)))


def off_m(robot: Robot, name: str, base_T_can: Pose2) -> float:
    return math.dist(robot.belief.gaussian("pose", name).mean[:2], base_T_can[:2])


def rmse(squares: list[float]) -> float:
    return math.sqrt(float(np.mean(squares)))


def place(robot: Robot, name: str) -> NDArray[np.float64]:
    return robot.belief.gaussian("pose", name).mean[:2]


def test_gross_errors_cost_little_accuracy_leave_no_ghosts_and_lose_nothing() -> None:
    clean, gross = [], []
    for seed in range(SEEDS):
        clean += run(seed, 0.0, 0.0)[2]
        robot, truth, squares = run(seed, SHARE, SHARE)
        gross += squares
        listed = [name for name in robot.belief.anchors() if name != "table1"]
        assert set(CANS) <= set(listed)
        ghosts = [n for n in listed if all(math.dist(place(robot, n), p[:2]) > NEAR_M for p in truth.values())]
        assert ghosts == []
        assert len(listed) == len(CANS)
    assert rmse(gross) < 1.2 * rmse(clean)
