"""Possible worlds of a real belief: against worlds that are drawn one by one from its joint Gaussian."""

from collections.abc import Mapping

import numpy as np
import pytest
from kit.beliefs import Robot, prior
from kit.papers import shipped
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from skolem.estimation.belief import Belief
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.pose_graph import Joint, PoseGraph
from skolem.estimation.se2 import compose, exp
from skolem.reasoner.language.parser import parse_lambda
from skolem.reasoner.worlds.circuits import compile_description
from skolem.reasoner.worlds.evaluator import Evaluator, Interval
from skolem.traces.messages import Pose2, Relation

DRAWS = 4000
SIGMAS = 4.0  # a chance of 6e-5 for each comparison
LINEAR = 0.01  # the belief's places are linear in the tangents, those of the drawn worlds are not
CLUSTER = {f"can{i}": (0.9 + 0.1 * (i % 2), -0.1 + 0.09 * i, 0.0) for i in range(5)}
EDGE = {"can1": (0.71, 0.0, 0.0), "can2": (0.9, 0.55, 0.0), "can3": (0.95, 0.0, 0.0)}


def cans(places: Mapping[str, Pose2]) -> Belief:
    return Robot(prior(dict(places))).belief


def table(text: str, belief: Belief) -> Mapping[str, Interval]:
    book = shipped()
    circuit = compile_description(parse_lambda(text, book.vocabulary.words(), belief.anchors()), book)
    return Evaluator({"e1": circuit}, book.vocabulary, text).table("e1", belief)


def drawn(belief: Belief, anchors: tuple[str, ...]) -> NDArray[np.float64]:
    """Return places of objects in worlds drawn from the belief, shape (DRAWS, anchors, 2), world frame."""
    graph = PoseGraph(EstimatorConfig())
    for event in belief.events:
        graph.apply(event)
    joint: Joint = graph.joint(anchors)
    draw = Generator(PCG64(SeedSequence([7])))
    tangents = draw.multivariate_normal(np.zeros(3 * len(anchors)), joint.covariance, DRAWS, method="svd")
    return np.array(
        [
            [compose(pose, exp(row[3 * i : 3 * i + 3]))[:2] for i, pose in enumerate(joint.world_T_body)]
            for row in tangents
        ]
    )


def agrees(found: Interval, share: float) -> None:
    spread = SIGMAS * max(share * (1.0 - share), 1e-3) ** 0.5 / DRAWS**0.5 + LINEAR
    assert found.low - spread <= share <= found.high + spread


def test_near_a_soda_in_a_cluster_is_what_drawn_worlds_say() -> None:
    belief = cans(CLUSTER)
    anchors = tuple(CLUSTER)
    found = table("lambda x. exists y. (Near(x, y) & Soda(y))", belief)
    distance = shipped().vocabulary.near_m["near"]
    at = drawn(belief, anchors)
    near = np.linalg.norm(at[:, :, None] - at[:, None, :], axis=-1) <= distance
    draw = Generator(PCG64(SeedSequence([8])))
    exists = draw.random((DRAWS, len(anchors))) < [belief.prob_exists(anchor) for anchor in anchors]
    soda = exists & (draw.random((DRAWS, len(anchors))) < 0.8)
    near &= ~np.eye(len(anchors), dtype=bool)
    for i, anchor in enumerate(anchors):
        agrees(found[anchor], float((exists[:, i] & (near[:, i] & soda).any(axis=1)).mean()))
        assert found[anchor].points > 0
        assert found[anchor].high - found[anchor].low < 0.03


def test_a_table_with_a_soda_at_its_edge_is_what_drawn_worlds_say() -> None:
    """Things on one table are on it together or not at all, as far as its own place is uncertain."""
    belief = cans(EDGE)
    found = table("lambda x. exists y. (On(y, x) & Soda(y))", belief)["table1"]
    model = belief.relations([Relation(kind="on", anchors=(can, "table1")) for can in EDGE])
    draw = Generator(PCG64(SeedSequence([9])))
    on = model.truth(draw.random((DRAWS, model.dimension)))
    exists = draw.random((DRAWS, 3)) < [belief.prob_exists(can) for can in EDGE]
    soda = exists & (draw.random((DRAWS, 3)) < 0.8)
    agrees(found, belief.prob_exists("table1") * float((on & soda).any(axis=1).mean()))


@pytest.mark.parametrize("places", [CLUSTER, EDGE])
def test_each_relation_alone_is_as_likely_as_the_belief_says(places: Mapping[str, Pose2]) -> None:
    belief = cans(places)
    asked = [Relation(kind="on", anchors=(can, "table1")) for can in places]
    asked += [Relation(kind="near", anchors=(a, b), distance_m=0.25) for a in places for b in places if a < b]
    expected = [
        belief.prob_on(*one.anchors)
        if one.kind == "on"
        else belief.prob_near(one.anchors[0], one.anchors[1], one.distance_m)
        for one in asked
    ]
    model = belief.relations(asked)
    truth = model.truth(Generator(PCG64(SeedSequence([3]))).random((20_000, model.dimension)))
    assert truth.mean(axis=0) == pytest.approx(expected, abs=SIGMAS * 0.5 / 20_000**0.5)


def test_the_heaviest_and_the_lightest_share_out_all_cases() -> None:
    """Each can may be the heaviest; without strangers the chances sum to P(there is a can)."""
    robot = Robot(prior({name: EDGE[name] for name in EDGE}))
    for kind in ("heaviest", "lightest"):
        found = table(f"{kind} x. Soda(x)", robot.belief)
        cans_found = [found[can] for can in EDGE]
        each = belief_that_none(robot.belief)
        total = sum(one.middle for one in cans_found)
        assert total == pytest.approx(1.0 - each, abs=sum(one.high - one.low for one in cans_found))
        assert cans_found[0].middle == pytest.approx(cans_found[1].middle, abs=0.02)


def belief_that_none(belief: Belief) -> float:
    return float(np.prod([1.0 - 0.8 * belief.prob_exists(can) for can in EDGE]))


def test_heavier_than_by_weighing_is_believed() -> None:
    robot = Robot(prior(dict(EDGE)))
    book = shipped()
    text = "lambda x. exists y. (HeavierThan(x, y) & Soda(y))"
    before = table(text, robot.belief)["can1"]
    both = table("lambda x. HeavierThan(x, can2)", robot.belief)["can1"]
    assert 0.0 < both.low < 0.99**2 / 2.0 < both.high  # weights of equal priors, both exist
    assert before.low > both.high * 0.8
    assert book.vocabulary.exceeds


def test_the_nearest_is_never_the_object_itself() -> None:
    belief = cans(CLUSTER)
    found = table("nearest x to can2. Soda(x)", belief)
    assert found["can2"] == Interval(0.0, 0.0)
    some = 1.0 - np.prod([1.0 - 0.8 * belief.prob_exists(can) for can in CLUSTER if can != "can2"])
    cans_found = [found[can] for can in CLUSTER]
    total, width = sum(one.middle for one in cans_found), sum(one.high - one.low for one in cans_found)
    assert total == pytest.approx(some * belief.prob_exists("can2"), abs=width)
