"""The drawn belief: the most likely types, and ellipsoids that cover two standard deviations."""

import math

import numpy as np
import pytest

from skolem.traces.messages import HsvBelief, ObjectBelief
from skolem.traces.scene.belief import SIGMAS, spread


def known(x: float = 1.0, **changes: object) -> ObjectBelief:
    before = ObjectBelief(
        exists=0.99,
        type={"bottle": 0.13, "can": 0.87},
        world_T_object=(x, 0.0, 0.68, 0.5),
        covariance=(4e-4, 1e-4, 0.0, 1e-4, 0.0, 0.01),
        colour=HsvBelief(mean=(0.33, 0.9, 0.8), variance=(0.001, 0.01, 0.01)),
        log_weight=(-1.2, 0.36),
    )
    return before.model_copy(update=changes)


def test_the_ellipsoid_has_the_axes_of_the_covariance_turned_with_the_object() -> None:
    one = known()
    drawn = spread(one.world_T_object, one.covariance, 0.0, (255, 255, 255, 255))
    a, b, _, c, _, _ = one.covariance
    variances, axes = np.linalg.eigh(np.array([[a, b], [b, c]]))
    (half_sizes,) = drawn.half_sizes.as_arrow_array().to_pylist()  # type: ignore[union-attr]
    (quaternion,) = drawn.quaternions.as_arrow_array().to_pylist()  # type: ignore[union-attr]
    assert half_sizes[:2] == pytest.approx(SIGMAS * np.sqrt(variances[::-1]), rel=1e-5)
    longest = one.world_T_object[3] + math.atan2(axes[1, 1], axes[0, 1])
    turn = 2.0 * math.atan2(quaternion[2], quaternion[3])
    assert math.sin(turn - longest) == pytest.approx(0.0, abs=1e-6)
