"""Why plans were dropped: the fluents of pre-images that became false, and the observation that made them false."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from skolem.reasoner.terms import parse_term
from skolem.tools.explain.insight import Course, Insight, Truth, mentioned, truth
from skolem.traces.messages import Belief, ObjectBelief, Plan, PlanStep

MOVED_M = 0.02  # smaller moves are not shown
NOTABLE = 0.02  # smaller changes of a probability are not shown


@dataclass(frozen=True, slots=True)
class Lost:
    """A step that can no longer be taken.

    Attributes:
        op: The step.
        fluents: The false fluents of its pre-image, in the present belief.
        before: Probability of each before the last action; None if it is not a probability.
    """

    op: str
    fluents: tuple[Truth, ...]
    before: tuple[float | None, ...]


@dataclass(frozen=True, slots=True)
class Drop:
    """A plan that was given up.

    Attributes:
        cause: `preimage_lost` or `refused`, as recorded.
        layer: Its layer of the stack; the layers below were dropped with it.
        steps: Its steps; empty if it was made and given up at this decision.
        lost: The steps, each with its false fluents.
        refused: The steps found impossible in the believed world.
        after: The action before the decision; empty at the first decision.
        sensed: The observation after that action.
        changed: The changes of the belief about the objects concerned.
    """

    cause: str
    layer: int
    steps: tuple[str, ...]
    lost: tuple[Lost, ...] = ()
    refused: tuple[str, ...] = ()
    after: str = ""
    sensed: str = ""
    changed: tuple[str, ...] = ()


def truths(insight: Insight, stack: Sequence[Sequence[PlanStep]]) -> dict[str, Truth]:
    """Return the truth of every fluent of a stack's pre-images."""
    fluents = {fluent for layer in stack for step in layer for fluent in step.preimage}
    return {fluent: truth(insight, parse_term(fluent)) for fluent in sorted(fluents)}


def drops(course: Course, now: Mapping[str, Truth], before: Mapping[str, Truth]) -> tuple[Drop, ...]:
    """Return every plan dropped at a decision, in order."""
    found: list[Drop] = []
    left = list(course.stack)
    for plan in course.found.all_of(Plan):
        kept = len(plan.layers)
        layer = left[kept] if kept < len(left) else ()
        if plan.cause == "preimage_lost":
            found.append(_lost_plan(course, kept, layer, now, before))
        elif plan.cause == "refused":
            found.append(Drop("refused", 0, (), refused=plan.false_fluents))
        del left[kept:]
    return tuple(found)


def _lost_plan(
    course: Course,
    at: int,
    layer: Sequence[PlanStep],
    now: Mapping[str, Truth],
    before: Mapping[str, Truth],
) -> Drop:
    steps = tuple(step.op for step in layer)
    lost = tuple(_lost(step.preimage, name, now, before) for step, name in zip(layer, steps, strict=True))
    lost = tuple(each for each in lost if each.fluents)
    about = {name for each in lost for found in each.fluents for name in mentioned(parse_term(found.fluent))}
    last = course.before
    return Drop(
        cause="preimage_lost",
        layer=at,
        steps=steps,
        lost=lost,
        after="" if last is None or last.action is None else last.action.op,
        sensed=_sensed(course),
        changed=tuple(_changes(last.belief if last else None, course.found.belief, about)),
    )


def _lost(preimage: tuple[str, ...], op: str, now: Mapping[str, Truth], before: Mapping[str, Truth]) -> Lost:
    false = [now[fluent] for fluent in preimage if fluent in now and now[fluent].holds is False]
    earlier = tuple(before[found.fluent].probability if found.fluent in before else None for found in false)
    return Lost(op, tuple(false), earlier)


def _sensed(course: Course) -> str:
    met = None if course.before is None else course.before.met
    if met is None:
        return ""
    result, observation = met
    said = "" if result.status == "done" else f"{result.status}; "
    match observation.kind:
        case "look":
            number = len(observation.detections)
            return f"{said}a look with {number} detection{'s' * (number != 1)}"
        case "weigh" if observation.wrench is not None:
            return f"{said}{abs(observation.wrench.force_newton[2]):.2f} N at the wrist"
    return f"{said}nothing but the joints"


def _changes(before: Belief | None, after: Belief | None, about: set[str]) -> Iterator[str]:
    """Yield the changes of the belief about some objects and regions."""
    if before is None or after is None:
        return
    for name in after.anchors:
        if name in about and name not in before.objects:
            yield f"{name}: not known before"
        elif name in about:
            for text in _object_changes(before.objects[name], after.objects[name]):
                yield f"{name}: {text}"
    for name in before.anchors:
        if name in about and name not in after.anchors:
            left = after.objects[name].exists if name in after.objects else 0.0
            yield f"{name}: exists {before.objects[name].exists:.2f} -> {left:.2f}: not counted as known any more"
    for name, region in after.regions.items():
        if name in about and abs(region.seen - before.regions[name].seen) > NOTABLE:
            yield f"{name}: seen {before.regions[name].seen:.2f} -> {region.seen:.2f}"


def _object_changes(before: ObjectBelief, after: ObjectBelief) -> Iterator[str]:
    if abs(after.exists - before.exists) > NOTABLE:
        yield f"exists {before.exists:.2f} -> {after.exists:.2f}"
    for name in sorted(after.type):
        if abs(after.type[name] - before.type.get(name, 0.0)) > NOTABLE:
            yield f"{name} {before.type.get(name, 0.0):.2f} -> {after.type[name]:.2f}"
    if after.colour != before.colour:
        yield f"colour {_hsv(before)} -> {_hsv(after)}"
    if after.log_weight != before.log_weight:
        yield f"weight {_grams(before)} -> {_grams(after)}"
    if math.dist(after.world_T_object[:2], before.world_T_object[:2]) > MOVED_M:
        yield f"moved by {math.dist(after.world_T_object[:2], before.world_T_object[:2]):.2f} m"
    if after.in_hand != before.in_hand:
        yield f"in hand: {before.in_hand or 'no'} -> {after.in_hand or 'no'}"


def _hsv(known: ObjectBelief) -> str:
    """Return a colour in degrees of hue and percent of saturation and value, each with its standard deviation."""
    units = ((360.0, "degrees"), (100.0, "%"), (100.0, "%"))
    each = zip(("hue", "saturation", "value"), known.colour.mean, known.colour.variance, units, strict=True)
    return ", ".join(f"{n} {u * x:.0f} {unit} (sd {u * math.sqrt(v):.0f})" for n, x, v, (u, unit) in each)


def _grams(known: ObjectBelief) -> str:
    mean, variance = known.log_weight
    return f"{1000 * math.exp(mean):.0f} g (within a factor of {math.exp(math.sqrt(variance)):.2f})"
