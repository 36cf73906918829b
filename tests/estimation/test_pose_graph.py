import math

import gtsam
import numpy as np
import pytest
from kit.event_logs import began, graph_of, looked, random_log, relative
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Began, Event, Moved, Picked, PickFailed, Placed
from skolem.estimation.graph_state import grasp_factor
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.estimation.se2 import compose, exp, relative_jacobian, symmetric
from skolem.traces.errors import InternalError
from skolem.traces.messages import (
    Pose2,
)
from skolem.traces.messages.poses import flat


def sds(graph: PoseGraph, a: str, b: str) -> NDArray[np.float64]:
    return np.sqrt(np.diag(graph.relative(a, b)[1]))


# ---------------------------------------------------------------- laws


def test_incremental_joint_equals_batch_marginals_after_every_event() -> None:
    graph = PoseGraph(EstimatorConfig())
    for event in random_log(3):
        graph.apply(event)
        isam = graph.smoother
        keys = sorted(isam.getLinearizationPoint().keys())
        batch = gtsam.Marginals(isam.getFactorsUnsafe(), isam.getLinearizationPoint())
        expected = batch.jointMarginalCovariance(keys).fullMatrix()
        got = isam.jointMarginalCovariance(keys).fullMatrix()
        assert np.abs(got - expected).max() < 1e-9 * np.abs(expected).max()


def test_estimate_is_the_least_squares_solution() -> None:
    graph = graph_of(random_log(5))
    isam = graph.smoother
    best = gtsam.LevenbergMarquardtOptimizer(isam.getFactorsUnsafe(), isam.calculateBestEstimate()).optimize()
    for key in sorted(best.keys()):
        off = best.atPose2(key).localCoordinates(isam.calculateEstimatePose2(key))
        assert np.abs(off).max() < 2e-3  # below what a factor is relinearised for


def test_rebuilt_graph_is_the_same_to_the_last_bit() -> None:
    log = random_log(7)
    graph, again = graph_of(log), PoseGraph(EstimatorConfig())
    again.rebuild(log)
    names = (BASE, "can0", "can1", "can2", "can3", "_o3_")
    assert again.joint(names).world_T_body == graph.joint(names).world_T_body
    assert again.joint(names).covariance.tobytes() == graph.joint(names).covariance.tobytes()


@pytest.mark.parametrize(("sd_m", "sd_rad", "base_sd"), [(0.0, 0.05, 0.01), (0.0, 0.0, 0.5), (0.005, 0.5, 0.01)])
def test_drives_without_a_look_are_followed_whatever_the_wheels_and_the_start_are_like(
    sd_m: float, sd_rad: float, base_sd: float
) -> None:
    graph, draws = PoseGraph(EstimatorConfig()), Generator(PCG64(SeedSequence([0])))
    events: list[Event] = [began({"a": (1.0, 0.0, 0.0)}, base_sd=base_sd)]
    driven = (0.0, 0.0, 0.0)
    for _ in range(40):
        x, y, turn = (float(value) for value in draws.uniform(-3.0, 3.0, 3))
        events.append(Moved(start_T_end=(x, y, turn), sd_m=sd_m, sd_rad=sd_rad))
        driven = compose(driven, (x, y, turn))
    for event in events:
        graph.apply(event)
    assert graph.joint([BASE]).world_T_body[0][:2] == pytest.approx(driven[:2], abs=1e-6)
    again = PoseGraph(EstimatorConfig())
    again.rebuild(events)
    assert again.joint([BASE, "a"]).world_T_body == graph.joint([BASE, "a"]).world_T_body
    assert (again.joint([BASE, "a"]).covariance == graph.joint([BASE, "a"]).covariance).all()


def test_held_object_joint_agrees_with_its_relative_pose() -> None:
    graph = graph_of(random_log(3)[:8])
    joint = graph.joint((BASE, "can1", "can2"))
    mean, covariance = graph.relative(BASE, "can1")
    jacobian = relative_jacobian(mean)
    assert covariance == pytest.approx(jacobian @ joint.covariance[:6, :6] @ jacobian.T)
    assert mean == pytest.approx(flat(graph.base_T_held("right")))


@pytest.mark.parametrize("scale", [0.05, 1.5])
def test_jacobian_of_a_grasp_agrees_with_differences_at_small_and_large_errors(scale: float) -> None:
    draws = Generator(PCG64(SeedSequence([11])))
    for _ in range(20):
        values = gtsam.Values()
        base, tool, grasp, off = (exp(draws.normal(size=3)) for _ in range(4))
        values.insert(1, gtsam.Pose2(*base))
        values.insert(3, gtsam.Pose2(*grasp))
        shifted = compose(compose(base, compose(tool, grasp)), exp(np.clip(scale * np.array(off), -2.5, 2.5)))
        values.insert(2, gtsam.Pose2(*shifted))
        factor = grasp_factor(1, 2, 3, tool, (1.0, 1.0))
        got = factor.linearize(values).jacobian()[0]
        columns = []
        for key in (1, 2, 3):
            for axis in range(3):
                step, errors = np.zeros(3), []
                for sign in (1e-6, -1e-6):
                    step[axis] = sign
                    moved = gtsam.Values(values)
                    moved.update(key, values.atPose2(key).retract(step))
                    errors.append(factor.unwhitenedError(moved))
                columns.append((errors[0] - errors[1]) / 2e-6)
        assert np.abs(got - np.array(columns).T).max() < 1e-7


# ---------------------------------------------------------------- what it is for


def test_relative_pose_is_known_far_better_than_the_world_pose_after_a_drive() -> None:
    """The chain of a drive, three looks, a pick, a drive, a place and a look."""
    log: list[Event] = [began({"can": (2.0, 0.5, 0.3)}), Moved(start_T_end=(1.3, 0.4, 0.05), sd_m=0.05, sd_rad=0.05)]
    assert sds(graph_of(log), BASE, "can") == pytest.approx((0.112, 0.119, 0.206), abs=2e-3)
    log += [looked({"can": (0.72, 0.06, 0.24)})] * 3
    graph = graph_of(log)
    assert np.sqrt(np.diag(graph.joint(("can",)).covariance))[0] > 0.04
    assert sds(graph, BASE, "can") == pytest.approx((0.006, 0.006, 0.017), abs=1e-3)
    tool, planned = (0.55, 0.06, 0.75, 0.24), (0.17, 0.0, -0.05, 0.0)
    log += [
        Picked(hand="right", anchor="can", base_T_tool=tool, tool_T_object=planned),
        Moved(start_T_end=(0.0, -1.0, -1.2), sd_m=0.05, sd_rad=0.05),
    ]
    assert graph_of(log).base_T_held("right")[:2] == pytest.approx((0.951 + 0.17, -0.188), abs=0.05)
    place = Placed(
        hand="right",
        anchor="can",
        base_T_tool=(0.6, -0.1, 0.75, 0.1),
        tool_z_object=-0.05,
        support=None,
        sd_m=0.01,
        sd_rad=0.03,
    )
    placed = graph_of([*log, place])
    seen = graph_of([*log, place, looked({"can": placed.relative(BASE, "can")[0]})])
    assert 0.01 < sds(placed, BASE, "can")[0] < 0.017
    assert (sds(seen, BASE, "can") < sds(placed, BASE, "can")).all()


def test_mean_alone_is_that_of_the_relative_pose() -> None:
    graph = graph_of(random_log(7))
    for a, b in ((BASE, "can1"), ("can0", "can2"), ("can3", BASE)):
        assert graph.mean(a, b) == graph.relative(a, b)[0]


def test_how_far_apart_two_places_are_agrees_with_differences_on_the_joint() -> None:
    graph = graph_of(random_log(3))
    joint = graph.joint((BASE, "can0", "can2"))

    def apart(tangent: NDArray[np.float64]) -> NDArray[np.float64]:
        base, a, b = (compose(p, exp(tangent[3 * i : 3 * i + 3])) for i, p in enumerate(joint.world_T_body))
        return np.subtract(relative(base, b), relative(base, a))[:2]

    steps = 1e-6 * np.eye(9)
    jacobian = np.array([(apart(step) - apart(-step)) / 2e-6 for step in steps]).T
    off, covariance = graph.apart("can0", "can2")
    assert off == pytest.approx(apart(np.zeros(9)))
    assert covariance == pytest.approx(jacobian @ joint.covariance @ jacobian.T, rel=1e-6, abs=1e-12)


def test_sd_of_a_prior_lies_along_the_axes_of_the_object() -> None:
    mean, covariance = graph_of([began({"can": (1.0, 0.0, math.pi / 2)}, base_sd=0.0)]).relative(BASE, "can")
    assert mean == pytest.approx((1.0, 0.0, math.pi / 2))
    assert np.sqrt(np.diag(covariance)) == pytest.approx((0.1, 0.1, 0.2), abs=1e-4)


def test_error_of_a_camera_is_shared_by_what_it_saw_and_so_averages_over_looks_only() -> None:
    wide = (1e-2, 0.0, 0.0, 1e-2, 0.0, 1e-6)
    cans: dict[str, Pose2] = {f"can{i}": (1.0, 0.1 * i, 0.0) for i in range(4)}
    one = graph_of([began(cans, sd_m=10.0), looked({"can0": cans["can0"]}, camera=wide)])
    four = graph_of([began(cans, sd_m=10.0), looked(cans, camera=wide)])
    assert sds(four, BASE, "can0")[0] == pytest.approx(sds(one, BASE, "can0")[0], rel=0.01)
    assert sds(four, "can1", "can0")[0] < 0.02


def test_event_about_an_unknown_object_leaves_no_trace() -> None:
    log = random_log(9)
    graph, untouched = graph_of(log), graph_of(log)
    misfits = (
        looked({"can0": (1.0, 0.0, 0.0), "nobody": (1.0, 0.0, 0.0)}),
        PickFailed(anchor="nobody"),
        Placed(
            hand="left",
            anchor="can0",
            base_T_tool=(0.6, -0.1, 0.7, 0.1),
            tool_z_object=0.0,
            support=None,
            sd_m=0.01,
            sd_rad=0.01,
        ),
    )
    for event in misfits:
        with pytest.raises(InternalError, match="does not fit the pose graph"):
            graph.apply(event)
    names = (BASE, "can0", "can2")
    assert graph.joint(names).covariance.tobytes() == untouched.joint(names).covariance.tobytes()
    assert graph.smoother.getFactorsUnsafe().size() == untouched.smoother.getFactorsUnsafe().size()


def test_question_about_an_unknown_object_names_the_known_ones() -> None:
    with pytest.raises(InternalError, match="no anchor 'x'; there are: can"):
        graph_of([began({"can": (1.0, 0.0, 0.0)})]).relative(BASE, "x")


def test_base_covariance_is_that_of_its_own_frame() -> None:
    start = began({}).prior.model_copy(update={"world_T_base": (0.0, 0.0, math.pi / 2)})
    graph = graph_of([Began(prior=start), Moved(start_T_end=(1.0, 0.0, 0.0), sd_m=0.0, sd_rad=0.0)])
    assert graph.joint((BASE,)).world_T_body[0] == pytest.approx((0.0, 1.0, math.pi / 2))
    # a heading off by .01 rad at the start is 1 cm to the left after 1 m
    assert graph.joint((BASE,)).covariance == pytest.approx(symmetric((1e-4, 0.0, 0.0, 2e-4, 1e-4, 1e-4)), abs=1e-7)
