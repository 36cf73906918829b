import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from kit.draws import examples

from skolem.estimation.se2 import (
    adjoint,
    between,
    compose,
    exp,
    inverse,
    log,
    relative_jacobian,
    symmetric,
    turned,
    upper,
)
from skolem.traces.messages import Pose2

POSES = st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3.1, 3.1))
LAWS = examples(50)


@LAWS
@given(POSES, POSES, POSES)
def test_composition_is_a_group(a: Pose2, b: Pose2, c: Pose2) -> None:
    left, right = compose(compose(a, b), c), compose(a, compose(b, c))
    assert log(between(left, right)) == pytest.approx(np.zeros(3), abs=1e-12)
    assert compose(a, inverse(a)) == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert log(between(compose(a, between(a, b)), b)) == pytest.approx(np.zeros(3), abs=1e-12)


@LAWS
@given(POSES)
def test_log_undoes_exp(tangent: Pose2) -> None:
    assert log(exp(np.array(tangent))) == pytest.approx(tangent, abs=1e-9)


@LAWS
@given(POSES, POSES)
def test_adjoint_carries_a_motion_to_the_other_side(pose: Pose2, motion: Pose2) -> None:
    after = compose(pose, exp(np.array(motion)))
    before = compose(exp(adjoint(pose) @ np.array(motion)), pose)
    assert log(between(after, before)) == pytest.approx(np.zeros(3), abs=1e-9)


@LAWS
@given(POSES, POSES)
def test_jacobian_of_a_relative_pose_agrees_with_differences(a: Pose2, b: Pose2) -> None:
    at, columns = between(a, b), []
    for axis in range(6):
        step = np.zeros(6)
        step[axis] = 1e-6
        moved = between(compose(a, exp(step[:3])), compose(b, exp(step[3:])))
        columns.append(log(between(at, moved)) / 1e-6)
    assert relative_jacobian(at) == pytest.approx(np.array(columns).T, abs=1e-4)


def test_turned_covariance_keeps_its_shape_and_turns_its_axes() -> None:
    covariance = np.diag([4.0, 1.0, 9.0])
    assert turned(covariance, math.pi / 2) == pytest.approx(np.diag([1.0, 4.0, 9.0]))
    assert symmetric(upper(turned(covariance, 0.3))) == pytest.approx(turned(covariance, 0.3))


def test_zero_has_no_sign_in_a_message() -> None:
    assert all(math.copysign(1.0, v) == 1.0 for v in upper(np.full((3, 3), -0.0)))
