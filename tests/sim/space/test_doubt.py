"""How far beside their places things may be: by formulas, and at a cost that does not grow with their pairs."""

import math
from unittest import mock

import numpy as np
import pytest
from kit import believed_scenes as scenes
from numpy.typing import NDArray

from skolem.sim.space import doubt
from skolem.sim.space.doubt import Doubts
from skolem.traces.messages import Belief, Pose2
from skolem.traces.messages.poses import compose2, flat, inverse2, raised

LIMIT_M = 10.0  # above every spread here


@pytest.fixture
def crowd() -> tuple[Belief, NDArray[np.float64]]:
    """Return a belief in six correlated cans, and its joint covariance."""
    rng, names = np.random.default_rng(3), [f"soda{i}" for i in range(6)]
    root = rng.normal(size=(21, 21)) * 0.01
    joint = root @ root.T
    joint = (joint + joint.T) / 2.0
    places = [raised((*rng.uniform(-2.0, 2.0, 2).tolist(), float(rng.uniform(-3.0, 3.0))), 0.68) for _ in names]
    objects = {name: scenes.believed("soda", place) for name, place in zip(names, places, strict=True)}
    keys = (*names[:2], "base", *names[2:])
    changes = {"keys": keys, "joint_covariance": tuple(joint[np.triu_indices(21)].tolist())}
    return scenes.belief(objects, (0.5, -0.4, 0.6)).model_copy(update=changes), joint


def straightforward(belief: Belief, joint: NDArray[np.float64], anchor: str, other: str) -> NDArray[np.float64]:
    """Return the covariance of other_T_anchor, shape (3, 3), by the whole Jacobian of all keys."""
    seen_from = flat(belief.objects[other].world_T_object) if other in belief.objects else belief.world_T_base
    x, y, theta = compose2(inverse2(flat(belief.objects[anchor].world_T_object)), seen_from)
    c, s = math.cos(theta), math.sin(theta)
    i, j = (3 * belief.keys.index(key) for key in (anchor, other))
    jacobian = np.zeros((3, len(joint)))
    jacobian[:, i : i + 3] = np.eye(3)
    jacobian[:, j : j + 3] = [[-c, s, -y], [-s, -c, x], [0.0, 0.0, -1.0]]
    return np.asarray(jacobian @ joint @ jacobian.T)


def test_doubt_relative_to_any_other_is_that_of_the_whole_jacobian(crowd: tuple[Belief, NDArray[np.float64]]) -> None:
    belief, joint = crowd
    for anchor in belief.anchors:
        sds = {}
        for other in (key for key in belief.keys if key != anchor):
            expected = straightforward(belief, joint, anchor, other)
            assert Doubts(belief).relative_covariance(anchor, other) == pytest.approx(expected, abs=1e-12)
            sds[other] = math.sqrt(np.linalg.eigvalsh(expected[:2, :2])[-1])
        steps = {key: 0.005 * math.ceil(2.0 * sd / 0.005) for key, sd in sds.items()}
        assert Doubts(belief).spread(anchor, LIMIT_M) == pytest.approx(steps["base"])
        assert Doubts(belief).own_spread(anchor, LIMIT_M) == pytest.approx(min(steps.values()))


def test_the_joint_covariance_is_unpacked_once_however_many_pairs_are_asked_about(
    crowd: tuple[Belief, NDArray[np.float64]],
) -> None:
    belief, _ = crowd
    with mock.patch.object(doubt, "_symmetric", wraps=doubt._symmetric) as unpack:
        doubts = Doubts(belief)
        for anchor in belief.anchors:
            doubts.own_spread(anchor, LIMIT_M)
    assert unpack.call_count == 1


def test_doubt_shared_with_the_base_is_no_doubt() -> None:
    """If all that is unknown is where the base stands, an object seen from it has no doubt at all."""
    world_T_base: Pose2 = (0.5, -0.4, 0.6)
    base_T_object: Pose2 = (0.8, 0.6, 0.3)
    x, y, theta = inverse2(base_T_object)
    c, s = math.cos(theta), math.sin(theta)
    adjoint = np.array([[c, -s, y], [s, c, -x], [0.0, 0.0, 1.0]])
    root = np.random.default_rng(0).normal(size=(3, 3)) * 0.05
    of_base = root @ root.T
    joint = np.block([[of_base, of_base @ adjoint.T], [adjoint @ of_base, adjoint @ of_base @ adjoint.T]])
    soda = scenes.believed("soda", raised(compose2(world_T_base, base_T_object), 0.68))
    belief = scenes.belief({"soda1": soda}, world_T_base).model_copy(
        update={"keys": ("base", "soda1"), "joint_covariance": tuple(joint[np.triu_indices(6)].tolist())}
    )
    assert Doubts(belief).relative_covariance("soda1") == pytest.approx(np.zeros((3, 3)), abs=1e-12)


def test_without_a_row_in_the_joint_covariance_the_marginal_counts() -> None:
    belief = scenes.belief(scenes.sodas(sd_m=0.02))
    assert Doubts(belief).relative_covariance("soda1")[:2, :2] == pytest.approx(np.eye(2) * 0.0004)


def test_doubt_that_things_share_does_not_count_among_them() -> None:
    """Two objects seen in one picture, far in doubt relative to the base, are known relative to each other."""
    first, second = scenes.believed("soda", (1.0, 0.0, 0.68, 0.0)), scenes.believed("soda", (1.2, 0.1, 0.68, 0.0))
    shared = np.diag([0.05, 0.05, 0.0]) ** 2
    own = np.eye(3) * 1e-6
    zero = np.zeros((3, 3))
    joint = np.block([[zero, zero, zero], [zero, shared + own, shared], [zero, shared, shared + own]])
    belief = scenes.belief({"a": first, "b": second}).model_copy(
        update={"keys": ("base", "a", "b"), "joint_covariance": tuple(joint[np.triu_indices(9)].tolist())}
    )
    assert Doubts(belief).spread("a", 0.05) == pytest.approx(0.05)
    assert Doubts(belief).own_spread("a", 0.05) == pytest.approx(0.005)
