import numpy as np
import pytest
from kit.beliefs import CANS, Robot, depth_view, detection, prior
from kit.event_logs import began, graph_of, looked, random_log

from skolem.estimation.belief import Belief
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import EVENT, Consolidated, Event, Moved, Picked, PickFailed
from skolem.estimation.fluents import covariance_within
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.traces.errors import InternalError
from skolem.traces.messages import Pose2
from skolem.traces.messages.poses import flat

NAMES = (BASE, "can0", "can1", "can2", "can3", "_o1_", "_o3_")
AROUND: dict[str, Pose2] = {f"can{i}": (1.0 + 0.3 * i, 0.2 * (-1) ** i, 0.0) for i in range(24)}


def along(moves: int, consolidate_every: int, coupled: int) -> PoseGraph:
    """Return the graph of a robot that passes a row of cans, three in sight at a time."""
    graph = PoseGraph(EstimatorConfig(coupled=coupled))
    graph.apply(began(AROUND))
    for step in range(moves):
        graph.apply(Moved(start_T_end=(0.3, 0.0, 0.0), sd_m=0.02, sd_rad=0.02))
        x = 0.3 * (step + 1)
        graph.apply(looked({a: (p[0] - x, p[1], p[2]) for a, p in AROUND.items() if 0.0 < p[0] - x < 1.0}))
        if step % consolidate_every == consolidate_every - 1:
            graph.apply(Consolidated())
    return graph


def test_summary_says_the_same_as_what_it_sums_up() -> None:
    graph = PoseGraph(EstimatorConfig())
    for i, event in enumerate(random_log(3)):
        graph.apply(event)
        if i == 12:
            before, factors = graph.joint(NAMES[:-1]), graph.smoother.getFactorsUnsafe().nrFactors()
            graph.apply(Consolidated())
            after = graph.joint(NAMES[:-1])
            assert np.array(after.world_T_body) == pytest.approx(np.array(before.world_T_body), abs=1e-3)
            assert after.covariance == pytest.approx(before.covariance, abs=1e-3 * np.abs(before.covariance).max())
            assert graph.smoother.getFactorsUnsafe().nrFactors() < factors / 2


def test_run_goes_on_after_a_summary_as_without_one() -> None:
    log = random_log(9, 12)
    plain, summed = graph_of(log), graph_of([*log[:16], Consolidated(), *log[16:]])
    a, b = plain.joint(NAMES), summed.joint(NAMES)
    sds = np.sqrt(np.diag(a.covariance)).reshape(-1, 3)
    assert (np.abs(np.array(a.world_T_body) - b.world_T_body) < 0.5 * sds).all()
    assert np.diag(b.covariance) == pytest.approx(np.diag(a.covariance), rel=0.1)


def test_held_object_stays_in_the_hand() -> None:
    log = random_log(3)
    pick = next(i for i, event in enumerate(log) if isinstance(event, Picked))
    plain, summed = graph_of(log[: pick + 1]), graph_of([*log[: pick + 1], Consolidated()])
    assert flat(summed.base_T_held("right")) == pytest.approx(flat(plain.base_T_held("right")), abs=1e-3)
    assert graph_of([*log[: pick + 1], Consolidated(), *log[pick + 1 :]]).relative(BASE, "can1")[1].trace() < 0.1


def test_factors_stay_bounded_and_small_and_beliefs_only_widen() -> None:
    exact, bounded = along(80, 10**9, 10**9), along(80, 6, 8)
    factors = bounded.smoother.getFactorsUnsafe()
    sizes = [len(factors.at(i).keys()) for i in range(factors.size()) if factors.exists(i)]
    assert max(sizes) <= 9
    assert len(sizes) < 2 * len(AROUND)
    assert len(bounded.smoother.getLinearizationPoint().keys()) < exact.smoother.getLinearizationPoint().size() / 4
    for anchor in ("can2", "can12", "can23"):
        tight, wide = (graph.joint((anchor,)).covariance for graph in (exact, bounded))
        assert covariance_within(tight, 1.001 * wide)
        assert np.trace(wide) < 2.0 * np.trace(tight)


def test_what_was_given_up_is_where_it_was_and_costs_nothing() -> None:
    graph = graph_of(random_log(5))
    place, keys = graph.mean(BASE, "_o2_"), graph.smoother.getLinearizationPoint().size()
    graph.apply(Consolidated(forgotten=("_o2_",)))
    assert graph.mean(BASE, "_o2_") == pytest.approx(place, abs=1e-3)
    assert "_o2_" in graph.forgotten
    assert graph.smoother.getLinearizationPoint().size() < keys / 2
    graph.apply(Consolidated())
    assert graph.mean("can0", "_o2_")


def test_misfitting_event_after_a_summary_leaves_no_trace() -> None:
    log: list[Event] = [*random_log(9), Consolidated()]
    graph, untouched = graph_of(log), graph_of(log)
    with pytest.raises(InternalError, match="does not fit the pose graph"):
        graph.apply(looked({"can0": (1.0, 0.0, 0.0), "nobody": (1.0, 0.0, 0.0)}))
    graph.apply(PickFailed(anchor="can0"))
    untouched.apply(PickFailed(anchor="can0"))
    assert graph.joint(NAMES).covariance.tobytes() == untouched.joint(NAMES).covariance.tobytes()


def test_long_run_is_summed_up_and_what_was_given_up_forgotten() -> None:
    robot = Robot(prior(), EstimatorConfig(consolidate_after=8))
    for look in range(20):
        ghost = [detection((0.8, 0.15, 0.0))] if look == 0 else []
        robot.look([*(detection(pose) for pose in CANS.values()), *ghost], depth_view(CANS.values()))
    assert [event.kind for event in robot.belief.events].count("consolidated") == 2
    assert robot.belief.anchors() == ("table1", *CANS)
    forgotten = [name for event in robot.belief.events if isinstance(event, Consolidated) for name in event.forgotten]
    assert forgotten == ["_o1_"]
    assert robot.belief.prob_near("_o1_", "can2", 0.01) < 0.01
    text = [EVENT.dump_json(event) for event in robot.belief.events]
    assert Belief.from_events(EVENT.validate_json(line) for line in text).snapshot(1) == robot.belief.snapshot(1)
