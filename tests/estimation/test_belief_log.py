"""A belief is its events: rebuilt from them, snapshot, and as sure as it is right."""

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from kit.beliefs import (
    CAMERA,
    CANS,
    FIT_SD,
    GRASP,
    NOISE,
    TABLE_TOP,
    TOOL,
    Robot,
    depth_view,
    detection,
    pose_of,
    prior,
    sees_all,
)
from kit.places import TESTS
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.belief import Belief
from skolem.estimation.events import EVENT
from skolem.estimation.se2 import between, compose, exp, inverse, log, relative_jacobian, symmetric
from skolem.traces.errors import InternalError
from skolem.traces.messages import Pose2

# ---------------------------------------------------------------- the log and the snapshot


def eventful() -> Robot:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.weigh(4.9)
    robot.drive((-0.1, 0.2, 0.3))
    robot.place("can2", "table1", (0.8, 0.1, 0.75, 0.0))
    robot.look([detection((0.81, 0.12, 0.0)), detection((0.7, -0.3, 0.0))], depth_view())
    robot.pick("can1", TOOL, GRASP, gap=0.0)
    return robot


def test_belief_rebuilt_from_its_events_is_the_same_to_the_last_bit() -> None:
    belief = eventful().belief
    text = [EVENT.dump_json(event) for event in belief.events]
    again = Belief.from_events(EVENT.validate_json(line) for line in text)
    assert again.version == belief.version
    assert again.snapshot(8).canonical() == belief.snapshot(8).canonical()


def test_snapshot_is_the_same_in_another_process() -> None:
    code = (
        "import hashlib; from test_belief_log import eventful;"
        "print(hashlib.sha256(eventful().belief.snapshot(8).canonical()).hexdigest())"
    )
    here = os.pathsep.join([str(Path(__file__).parent), str(TESTS)])
    digests = {
        subprocess.run(
            [sys.executable, "-c", code],
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": here},
            capture_output=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(digests) == 1


def test_order_in_which_the_detector_reports_decides_nothing() -> None:
    snapshots = []
    for turn in (1, -1):
        robot = Robot(prior())
        robot.look([detection(pose) for pose in ((0.7, 0.2, 0.0), *CANS.values(), (0.7, -0.2, 0.0))][::turn], None)
        snapshots.append(robot.belief.snapshot(1).canonical())
    assert snapshots[0] == snapshots[1]


def test_whether_two_things_are_near_does_not_depend_on_how_they_are_turned() -> None:
    robot = Robot(prior())
    sees_all(robot, times=4)
    apart = math.dist(CANS["can1"][:2], CANS["can2"][:2])
    assert math.sqrt(robot.belief.gaussian("pose", "can1").covariance[2, 2]) > 0.5
    for one, other in (("can1", "can2"), ("can2", "can1")):
        assert robot.belief.prob_near(one, other, apart + 0.03) > 0.99
        assert robot.belief.prob_near(one, other, apart - 0.03) < 0.01


def test_joint_covariance_of_the_snapshot_gives_the_relative_pose() -> None:
    robot = eventful()
    belief = robot.belief.snapshot(8)
    size = 3 * len(belief.keys)
    joint = np.zeros((size, size))
    joint[np.triu_indices(size)] = belief.joint_covariance
    joint += np.triu(joint, 1).T
    assert belief.keys == ("base", *belief.anchors)
    assert joint[:3, :3] == pytest.approx(symmetric(belief.base_covariance))
    for name in ("can2", "can3"):
        at = 3 * belief.keys.index(name)
        index = [0, 1, 2, at, at + 1, at + 2]
        jacobian = relative_jacobian(between(belief.world_T_base, pose_of(robot, name)))
        expected = robot.belief.gaussian("pose", name).covariance
        assert jacobian @ joint[np.ix_(index, index)] @ jacobian.T == pytest.approx(expected, rel=1e-6, abs=1e-12)


def test_misfitting_event_changes_nothing() -> None:
    robot = eventful()
    before, version = robot.belief.snapshot(8), robot.belief.version
    placed = next(event for event in robot.belief.events if event.kind == "placed")
    with pytest.raises(InternalError, match="'placed' does not fit"):
        robot.belief.apply(placed)
    assert robot.belief.version == version
    assert robot.belief.snapshot(8) == before


# ---------------------------------------------------------------- consistency


def run_truth(seed: int) -> list[float]:
    """Return squared normalised errors of cans relative to the base; the noise is what the belief assumes."""
    draws = Generator(PCG64(SeedSequence([seed])))
    told = prior(sd_m=0.03)
    base = compose(told.world_T_base, exp(draws.normal(size=3) * 0.01))
    truth = {name: (x + draws.normal() * 0.03, y + draws.normal() * 0.03, 0.0) for name, (x, y, _) in CANS.items()}
    robot, errors = Robot(told), []
    for step in range(8):
        if step % 2:
            motion = tuple(float(v) for v in draws.uniform(-0.1, 0.1, 3))
            sd_m, sd_rad = 0.005 + 0.02 * math.hypot(*motion[:2]), 0.01 + 0.02 * abs(motion[2])
            base = compose(
                compose(base, (motion[0], motion[1], motion[2])), exp(draws.normal(size=3) * (sd_m, sd_m, sd_rad))
            )
            robot.drive((motion[0], motion[1], motion[2]))
        plane = math.hypot(NOISE.extrinsics_sd_m, NOISE.extrinsics_sd_rad * (CAMERA[2] - TABLE_TOP))
        shift = exp(draws.normal(size=3) * (plane, plane, NOISE.extrinsics_sd_rad))
        at_camera: Pose2 = (CAMERA[0], CAMERA[1], 0.0)
        error = compose(compose(at_camera, shift), inverse(at_camera))
        seen = [
            compose(compose(error, between(base, can)), exp(draws.normal(size=3) * (FIT_SD, FIT_SD, 0.0)))
            for can in truth.values()
        ]
        robot.look([detection(pose) for pose in seen], None)
        for name, can in truth.items():
            belief = robot.belief.gaussian("pose", name)
            x, y, theta = belief.mean.tolist()
            off = log(between((x, y, theta), (*between(base, can)[:2], theta)))[:2]
            errors.append(float(off @ np.linalg.solve(belief.covariance[:2, :2], off)))
    assert robot.belief.anchors() == ("table1", *CANS)
    return errors


def test_errors_are_as_large_as_the_belief_says() -> None:
    nees = np.mean([error for seed in range(20) for error in run_truth(seed)])
    assert 1.3 < nees < 2.7  # 2 for a planar position; 480 correlated samples
