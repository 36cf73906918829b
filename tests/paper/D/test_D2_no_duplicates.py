"""D2: looking again and again at the same objects adds none."""

import numpy as np
import pytest
from kit.papers import Handler, at_five_percent, can, seen_as
from kit.runs import with_physics

from skolem.traces.messages import Pose4

LOOKS = 200
SEEN_SD_M = 0.002  # what the detections of `searches` claim
PLACES = [(0.95 + 0.1 * k, 0.2 * k - 0.4, 0.7, 0.0) for k in range(5)]


def test_two_hundred_looks_at_five_objects_leave_five_anchors() -> None:
    """ "A high-fidelity belief-update step based on object detections." """
    robot = Handler(at_five_percent([can(f"can{k}", world_T_object=place) for k, place in enumerate(PLACES)]))
    draws = np.random.Generator(np.random.PCG64(0))
    for _ in range(LOOKS):
        seen: list[Pose4] = [(*(place[:2] + draws.normal(size=2) * SEEN_SD_M).tolist(), 0.7, 0.0) for place in PLACES]
        robot.see(*map(seen_as, seen))
    assert robot.belief.anchors() == ("table1", "can0", "can1", "can2", "can3", "can4")


@pytest.mark.physics
@pytest.mark.parametrize("name", ["sim1_green", "sim2_heavy_soda", "real1_oil"])
def test_a_whole_run_among_known_objects_ends_with_the_anchors_it_began_with(name: str) -> None:
    """ "Objects that the robot discovers" are added, and no others; over seeds: `skolem sweep`, docs/results.md."""
    run = with_physics(name)
    assert sum(len(seen.detections) for seen in run.observations) >= 6
    last = run.beliefs[-1]
    assert tuple(anchor for anchor in last.anchors if last.objects[anchor].exists >= 0.5) == run.known()
