"""D5: one reading of the noisy sensor may not be enough; then the same object is weighed again."""

import math
from itertools import groupby

from kit.papers import normal_tail
from kit.runs import Run, ran

SEEDS = range(20)  # in about every sixth, one reading of the 500 g leaves it open whether it weighs 400 g
SHARE = 0.9 ** (1 / 3)  # of each of three properties, so that together they reach .9


def weighed_again(run: Run) -> tuple[int, ...]:
    """Return the numbers of the weighings, one right after another, of the object that was meant; () if only one."""
    wanted = f"Weigh({run.end.anchor})"
    groups = groupby(enumerate(run.operators), key=lambda numbered: numbered[1])
    found = (tuple(i for i, _ in group) for row, group in groups if row == wanted)
    return next((numbers for numbers in found if len(numbers) > 1), ())


def test_an_object_is_weighed_until_it_is_sure_enough_to_be_heavy() -> None:
    """ "A (very noisy) 6-axis force-torque sensor ... indirect observations of the weight"."""
    run = next(run for run in (ran("illustrative", seed) for seed in SEEDS) if run.achieved and weighed_again(run))
    numbers = weighed_again(run)
    anchor = run.end.anchor
    assert anchor is not None
    believed = [run.beliefs[i].objects[anchor].log_weight for i in (numbers[0], *(i + 1 for i in numbers))]
    variances = [variance for _, variance in believed]
    assert variances == sorted(variances, reverse=True)
    assert len(set(variances)) == len(variances)
    heavy = [normal_tail(math.log(0.4), mean, math.sqrt(variance)) for mean, variance in believed]
    assert max(heavy[:-1]) < SHARE
    assert heavy[-1] >= 0.9
    wrenches = [run.observations[i].wrench for i in numbers]
    assert len({wrench.force_newton for wrench in wrenches if wrench is not None}) == len(numbers)
    assert (run.verdict.true, run.verdict.witness) == (True, "o4")
