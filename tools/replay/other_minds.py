"""The mind of a recorded run with changed inputs: rules, goal, thresholds, limits or prior."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from skolem.reasoner import Goal
from skolem.reasoner.language.expressions import Believed
from skolem.reasoner.rulebook.book import Rulebook
from skolem.sim.scenario.scenario import Document, prior_of, read_document
from skolem.tools.loop.setup import understood
from skolem.tools.recorded.replaying import given_in
from skolem.tools.recorded.rethinking import Given
from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import RecordedRun
from skolem.traces.errors import Fault, InputError, TraceError
from skolem.traces.file.made_of import SCENARIO

THRESHOLD: Final = "threshold"
OF_MIND: Final = ("goal", "limits")  # keys of a scenario that change the mind, but not its prior
OF_PRIOR: Final = ("belief", "priors", "noise", "model")  # keys that change the prior


@dataclass(frozen=True, slots=True)
class Changes:
    """The changes of a mind's inputs.

    Attributes:
        rules: File name to content of the rule files that replace others or are added.
        overrides: Changed values `a.b=value` of the scenario, without the threshold.
        threshold: The new p of every B(phi, p) in the goal; None: unchanged.
    """

    rules: Mapping[str, bytes] = field(default_factory=dict)
    overrides: tuple[str, ...] = ()
    threshold: float | None = None

    def __bool__(self) -> bool:
        """Return whether there is any change."""
        return bool(self.rules or self.overrides or self.threshold is not None)


def changes_of(rules: Mapping[str, bytes], flags: Sequence[str]) -> Changes:
    """Return the changes by `--set` flags, together with those of the rules.

    Raises:
        InputError: If a flag would change the recorded world, or is no valid threshold.
    """
    faults = []
    overrides, threshold = [], None
    for flag in flags:
        key, _, value = flag.partition("=")
        if key == THRESHOLD:
            threshold = _probability(value)
            if threshold is None:
                faults.append(Fault(f"--set {flag}", 0, 0, "expected a probability between 0 and 1, both excluded"))
        elif key.partition(".")[0] not in (*OF_MIND, *OF_PRIOR):
            known = ", ".join((THRESHOLD, *OF_MIND, *OF_PRIOR))
            message = f"what was recorded cannot change: expected one of {known}; `skolem run --set` changes the world"
            faults.append(Fault(f"--set {flag}", 0, 0, message))
        else:
            overrides.append(flag)
    if faults:
        raise InputError(faults)
    return Changes(rules, tuple(overrides), threshold)


def given_with(run: RecordedRun, changes: Changes, rulebooks: Rulebooks) -> Given:
    """Return the changed inputs of a run's mind.

    Raises:
        InputError: With every fault of the changed rules or scenario.
        TraceError: If the trace does not hold its scenario.
    """
    if changes.overrides:
        given = _given_by_scenario(run, changes, rulebooks.of(run.attachments, changes.rules))
    else:
        given = given_in(run, rulebooks, changes.rules)
    return given if changes.threshold is None else replace(given, goal=_at(changes.threshold, given.goal))


def _given_by_scenario(run: RecordedRun, changes: Changes, rulebook: Rulebook) -> Given:
    """Return the inputs by the changed scenario; the prior stays as recorded unless a flag changes it."""
    set_anew = any(flag.startswith("belief.evaluation=") for flag in changes.overrides)
    kept = None if set_anew else run.start.evaluation or "independent"
    scenario, goal = understood(_document(run, changes.overrides), rulebook, kept)
    prior = run.prior
    if any(flag.partition("=")[0].partition(".")[0] in OF_PRIOR for flag in changes.overrides):
        prior = prior_of(scenario, rulebook.vocabulary.types, run.start.seed, run.prior.robot)
    elif changes.rules:
        prior = prior.model_copy(update={"types": dict(rulebook.vocabulary.types)})
    return Given(goal, rulebook, prior, scenario.limits)


def _document(run: RecordedRun, overrides: Sequence[str]) -> Document:
    if SCENARIO not in run.attachments:
        raise TraceError(f"{run.path}: holds no {SCENARIO}, so nothing of it can be set")
    return read_document(SCENARIO, run.attachments[SCENARIO].decode(errors="replace"), overrides)


def _at(threshold: float, goal: Goal) -> Goal:
    """Return the goal with another threshold in every B(phi, p)."""
    conjuncts = (replace(each, p=threshold) if isinstance(each, Believed) else each for each in goal.conjuncts)
    return replace(goal, conjuncts=tuple(conjuncts))


def _probability(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0.0 < value < 1.0 else None
