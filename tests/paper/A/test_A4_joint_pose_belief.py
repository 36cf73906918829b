"""A4: one joint Gaussian over all poses and the base, in tangent space."""

import math

import numpy as np
import pytest
from kit.papers import Handler, at_five_percent, can, seen_as
from numpy.typing import NDArray

from skolem.estimation.se2 import between, exp
from skolem.traces.messages import Pose2
from skolem.traces.messages.poses import wrap_exactly

A, B = (1.0, -0.2, 0.7, 0.0), (1.0, 0.2, 0.7, 0.0)


def observed() -> Handler:
    """A robot that has seen two cans well and has driven half a metre since."""
    cans = [can("a", 1.0, A, 0.01), can("b", 1.0, B, 0.01)]
    robot = Handler(at_five_percent(cans, odometry_sd_m=0.05, odometry_sd_rad=0.05))
    robot.see(seen_as(A), seen_as(B))
    robot.drive((0.3, 0.0, 0.1))
    return robot


def joint(robot: Handler) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Return the joint covariance of the snapshot, three rows for each key."""
    said = robot.belief.snapshot(0)
    size = 3 * len(said.keys)
    covariance = np.zeros((size, size))
    covariance[np.triu_indices(size)] = said.joint_covariance
    return said.keys, covariance + np.triu(covariance, 1).T


def test_all_poses_and_the_base_have_one_covariance() -> None:
    """ "A joint distribution over all object poses, together with the robot's base pose." """
    robot = observed()
    robot.see(seen_as((0.7, -0.27, 0.7, 0.0)))
    keys, covariance = joint(robot)
    assert keys == ("base", "table1", "a", "b")
    assert np.linalg.eigvalsh(covariance)[0] > 0.0
    assert np.abs(covariance[:3, 3 * keys.index("b") : 3 * keys.index("b") + 3]).max() > 1e-6


def test_seeing_one_object_after_a_drive_sharpens_the_other_too() -> None:
    """ "A joint distribution": what is learnt of one pose is learnt of those that hang together with it."""
    robot = observed()
    before = robot.belief.gaussian("pose", "b").covariance[:2, :2]
    x, y, theta = between((0.3, 0.0, 0.1), (A[0], A[1], 0.0))
    robot.see(seen_as((x, y, 0.7, theta)))
    after = robot.belief.gaussian("pose", "b").covariance[:2, :2]
    assert np.linalg.eigvalsh(before - after)[0] > 0.0
    assert np.trace(after) < 0.5 * np.trace(before)


def test_a_heading_goes_through_pi_without_a_jump() -> None:
    """ "Using a multivariate Gaussian in tangent space." """
    robot = Handler(at_five_percent(odometry_sd_rad=0.02))
    turns = [1.2, 1.2, 0.9, -0.3, 0.4]
    sds = []
    for turn in turns:
        robot.drive((0.0, 0.0, turn))
        sds.append(robot.belief.snapshot(0).base_covariance[5])
    heading = robot.belief.snapshot(0).world_T_base[2]
    assert -math.pi <= heading <= math.pi
    assert wrap_exactly(heading - sum(turns)) == pytest.approx(0.0, abs=1e-9)
    assert np.diff(sds) == pytest.approx([0.02**2] * 4, rel=1e-3)


def test_the_mean_moves_along_the_group_and_not_along_coordinates() -> None:
    """ "In tangent space": two sightings on either side of the turn average between them, not at zero."""
    robot = Handler(at_five_percent())
    robot.drive((0.0, 0.0, math.pi))
    start: Pose2 = robot.belief.snapshot(0).world_T_base
    robot.drive(exp(np.array([0.2, 0.0, 0.2])))
    moved = between(start, robot.belief.snapshot(0).world_T_base)
    assert moved == pytest.approx(exp(np.array([0.2, 0.0, 0.2])), abs=1e-9)
