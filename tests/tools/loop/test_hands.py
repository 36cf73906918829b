"""Whole runs in which somebody takes the object out of the hand: the belief follows what the fingers say."""

import pytest
from kit.runs import Run, ran

from skolem.traces.messages import Hand

NEVER = 59  # no run of this scenario has so many actions


def taken_before(step: int) -> Run:
    return ran("sim1_moved", overrides=(f"disturbances.0.before_step={step}",))


@pytest.mark.parametrize("moment", ["just after the pick", "just before the place"])
def test_an_object_taken_out_of_the_hand_is_missed_at_once_and_never_believed_to_be_placed(moment: str) -> None:
    undisturbed = taken_before(NEVER)
    place = undisturbed.where("Place")
    taken = undisturbed.where("Pick") + 1 if moment == "just after the pick" else place
    run = taken_before(taken)
    believed: list[set[tuple[str, Hand]]] = [
        {(name, item.in_hand) for name, item in belief.objects.items() if item.in_hand} for belief in run.beliefs
    ]
    true = [{(item.id, item.in_hand) for item in state.objects if item.in_hand} for state in run.truths]
    assert (believed[taken], believed[taken + 1]) == ({("sodaC", "left")}, set())
    assert believed[:taken] == true[:taken]
    assert believed[taken + 1 :] == true[taken + 1 :]
    assert len(run.operators) > place + 1
    assert (run.achieved, run.verdict.true, run.verdict.witness) == (True, True, "sodaC")
