"""The recorded codes in words: causes of plan changes, ends of runs, risks, and refusals by rules."""

from collections.abc import Mapping
from typing import Final

from skolem.traces.messages import PlanCause, RunStatus
from skolem.traces.wording.amounts import spaced

CAUSES: Final[Mapping[PlanCause, str]] = {
    "start": "new plan",
    "refine": "step planned in more detail",
    "skipped_forward": "went on to a later step",
    "fell_back": "went back to an earlier step",
    "preimage_lost": "plan dropped as what it needs is no longer so",
    "bind_skolem": "object to be found turned out to be a known one",
    "refused": "plan dropped as it cannot be carried out",
    "done": "goal achieved",
    "giveup": "given up",
}
STATUSES: Final[Mapping[RunStatus, str]] = {
    "goal_achieved": "goal believed achieved",
    "goal_unachievable": "goal not achieved, nothing is left to try",
    "no_referent": "nothing is what the goal means by `the`",
    "no_unique_referent": "several objects are what the goal means by `the`",
    "limit_reached": "goal not achieved, a limit was reached",
    "error": "internal error",
    "interrupted": "interrupted",
}
RISKS: Final[Mapping[str, str]] = {
    "ends_elsewhere": "the drive ends elsewhere",
    "lands_elsewhere": "the object lands elsewhere",
    "overlooked": "something is overlooked",
    "prior_of_description": "the object is not what is meant",
    "prior_of_existence": "no such object is there",
    "prior_of_property": "the object does not have the property",
    "prior_of_none": "such an object is hidden there",
    "prior_of_superlative": "a rival is ahead",
    "prior_of_relation": "the two objects do not stand so",
    "prior_of_refutation": "the object fits after all",
    "slips": "the object slips",
    "still_blocked": "the way is still blocked",
    "unfavourable_reading": "the sensor says otherwise",
    "way": "something happens on the way",
}
REFUSALS: Final[Mapping[str, str]] = {
    "no_room": "there is no room for it, whatever is taken away",
    "not_a_support": "nothing can be put on it",
    "not_graspable": "no hand can grasp it",
    "out_of_reach_of_the_sensor": "the sensor is not good enough to tell",
}


def in_words(code: str, table: Mapping[str, str]) -> str:
    """Return a code in words; an unknown one from a rule file, `too_slippery`, as `too slippery`."""
    return table.get(code) or spaced(code)
