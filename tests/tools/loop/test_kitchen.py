"""Words of one's own, and a description with two ways to be meant, over several seeds."""

import tempfile
from collections import Counter
from functools import cache
from pathlib import Path

import pytest
from kit.places import DATA

from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.tools.recorded.replaying import Options, replay
from skolem.tools.recorded.run import RecordedRun
from skolem.traces.compare.diff import Tolerance
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, RunEnd, RunStart

KITCHEN = DATA / "kitchen" / "kitchen.yaml"
SEEDS = range(4)
_FOLDER = tempfile.TemporaryDirectory(prefix="kitchen-")


@cache
def recorded(seed: int) -> Path:
    path = Path(_FOLDER.name) / f"{seed}.mcap"
    run(prepare(KITCHEN, (), seed, "symbolic"), path)
    return path


@pytest.mark.parametrize("seed", SEEDS)
def test_the_object_that_is_meant_in_the_other_way_is_found(seed: int) -> None:
    (end,) = Trace(recorded(seed)).of(RunEnd)
    assert (end.status, end.anchor) == ("goal_achieved", "mugT")


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_is_done_until_it_is_given_up_for_what_is_refuted_or_known_already(seed: int) -> None:
    trace = Trace(recorded(seed))
    (start,), done = trace.of(RunStart), Counter(action.op for action in trace.of(Action))
    assert max(done.values()) < start.limits.repeats, done


def test_the_run_is_thought_again_although_its_scenario_lists_shares_in_another_order_than_the_trace() -> None:
    """The shares .3, .4, .2 and .1 add up to 1 in one order, and to a little less in another."""
    replayed = replay(RecordedRun(recorded(0)), Options(Tolerance()))
    assert replayed.identical, replayed.comparison.divergences
