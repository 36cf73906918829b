import math

import numpy as np
from kit.beliefs import CANS, Robot, detection, prior
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.association import Measured, Pair, Scene, assign_jointly, is_ambiguous
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Looked
from skolem.estimation.se2 import between, exp
from skolem.traces.messages import Pose2

GATE, WIDTH = EstimatorConfig().gate, EstimatorConfig().hypotheses
SIGHT = np.diag([1e-6, 1e-6, 1e-4])
ROW: tuple[Pose2, ...] = ((1.0, -0.1, 0.0), (1.0, 0.0, 0.0), (1.0, 0.1, 0.0))


def scene(base_sd: float, objects: tuple[Pose2, ...] = ROW, sd: float = 0.005) -> Scene:
    sds = np.concatenate([[base_sd] * 3, *[[sd] * 3] * len(objects)])
    return Scene(((0.0, 0.0, 0.0), *objects), np.diag(sds**2))


def all_pairs(seen: list[Pose2], objects: tuple[Pose2, ...] = ROW) -> list[list[Pair]]:
    return [[Pair(j, Measured(pose, SIGHT), 2.0) for j in range(len(objects))] for pose in seen]


def jointly(base_sd: float, seen: list[Pose2], unmatched: float = -2.0) -> tuple[int | None, ...]:
    return assign_jointly(scene(base_sd), all_pairs(seen), np.full(len(seen), unmatched), [GATE] * len(seen), WIDTH)


def test_scores_are_ambiguous_if_something_has_a_choice() -> None:
    no = -math.inf
    assert not is_ambiguous(np.array([[1.0, no], [no, 2.0]]))
    assert is_ambiguous(np.array([[1.0, 0.5]]))
    assert is_ambiguous(np.array([[1.0], [0.5]]))
    assert not is_ambiguous(np.zeros((0, 2)))


def test_row_seen_shifted_by_one_place_is_told_from_its_ends() -> None:
    shifted = [(x, y + 0.1, theta) for x, y, theta in ROW]
    assert jointly(0.1, shifted) == (0, 1, 2)
    assert jointly(0.005, shifted) == (1, 2, None)


def test_first_pair_says_how_far_off_the_base_is_for_the_next() -> None:
    error = exp(np.array([0.03, 0.05, 0.04]))
    seen = [between(error, pose) for pose in ROW]
    assert jointly(0.1, seen) == (0, 1, 2)
    assert jointly(0.1, seen[::-1]) == (2, 1, 0)


def test_no_anchor_is_assigned_twice_and_clutter_to_none() -> None:
    assert jointly(0.005, [ROW[1], ROW[1]]).count(1) == 1
    assert jointly(0.005, [(1.5, 0.5, 0.0)]) == (None,)


def test_looks_without_detections_or_candidates_are_assigned() -> None:
    assert assign_jointly(scene(0.1), [], np.zeros(0), [], WIDTH) == ()
    assert assign_jointly(scene(0.1, ()), [[]], np.zeros(1), [GATE], WIDTH) == (None,)


def whole_look_is_right(seed: int, hypotheses: int) -> bool:
    """Return whether each of eight crowded cans that is reported is taken for itself, the base badly known."""
    draws = Generator(PCG64(SeedSequence([seed])))
    cans: dict[str, Pose2] = {f"can{i}": (0.7 + 0.09 * (i // 3), -0.09 + 0.09 * (i % 3), 0.0) for i in range(8)}
    error = exp(draws.normal(size=3) * (0.05, 0.05, 0.08))
    seen = {name: between(error, pose) for name, pose in cans.items() if draws.random() < 0.6}
    told = prior(cans, sd_m=0.01, base_sd=0.05).model_copy(update={"base_sd_theta_rad": 0.08})
    robot = Robot(told, EstimatorConfig(hypotheses=hypotheses))
    robot.look([detection(pose) for pose in seen.values()])
    (look,) = (event for event in robot.belief.events if isinstance(event, Looked))
    places = {s.anchor: s.detection.base_T_object[:2] for s in look.sightings}
    return {name: pose[:2] for name, pose in seen.items()} == places


def test_whole_looks_are_read_right_more_often_than_pair_by_pair() -> None:
    assert sum(whole_look_is_right(seed, WIDTH) for seed in range(10)) >= 9
    assert sum(whole_look_is_right(seed, 0) for seed in range(10)) <= 7


def test_unambiguous_look_is_read_alike_either_way() -> None:
    looks = []
    for hypotheses in (0, WIDTH):
        robot = Robot(prior(), EstimatorConfig(hypotheses=hypotheses))
        robot.look([detection(pose) for pose in CANS.values()])
        looks.append(robot.belief.events[-1])
    assert looks[0] == looks[1]
