"""Checks that a prior does not contradict itself. Pydantic has checked the types of its fields before."""

from collections.abc import Iterator

from skolem.estimation.pose_graph import BASE
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import Prior
from skolem.traces.messages.likeliest import likeliest


def check_prior(prior: Prior) -> None:
    """Check a prior.

    Raises:
        InputError: If there are faults; it lists all of them.
    """
    faults = list(_faults(prior))
    if faults:
        raise InputError(faults)


def _faults(prior: Prior) -> Iterator[Fault]:
    names = [item.anchor for item in prior.objects]
    for i, item in enumerate(prior.objects):
        at = f"objects.{i}"
        if names.index(item.anchor) != i:
            yield _fault(f"{at}.anchor", f"'{item.anchor}' is told twice")
        if item.anchor == BASE:
            yield _fault(f"{at}.anchor", f"'{BASE}' is the robot's base, not an object")
        if item.support is not None and (item.support not in names or item.support == item.anchor):
            yield _fault(f"{at}.support", f"no support '{item.support}'; there are: {', '.join(names)}")
        for kind in sorted(item.type.keys() - prior.types.keys()):
            yield _fault(f"{at}.type", f"no type '{kind}'; there are: {', '.join(sorted(prior.types))}")
        if sum(item.type.values()) <= 0.0:
            yield _fault(f"{at}.type", "no type has a probability above 0")
    yield from _region_faults(prior)
    for kind in sorted(prior.type):
        if kind not in prior.types or not prior.types[kind].graspable:
            known = ", ".join(sorted(name for name, other in prior.types.items() if other.graspable))
            yield _fault("type", f"an object that nobody has met cannot be of type '{kind}'; it can be: {known}")
    if prior.type and sum(prior.type.values()) <= 0.0:
        yield _fault("type", "no type has a probability above 0")
    if not any(kind.graspable for kind in prior.types.values()):
        yield _fault("types", "none is graspable, so nothing can be detected")
    if prior.noise.colour_gain <= 0.0:
        yield _fault("noise.colour_gain", f"{prior.noise.colour_gain} is not above 0")


def _region_faults(prior: Prior) -> Iterator[Fault]:
    objects = {item.anchor: item for item in prior.objects}
    names = [*objects, BASE, *(region.anchor for region in prior.regions)]
    for i, region in enumerate(prior.regions):
        at, support = f"regions.{i}", objects.get(region.support)
        if names.index(region.anchor) != len(objects) + 1 + i:
            yield _fault(f"{at}.anchor", f"'{region.anchor}' names something else already")
        if support is None:
            yield _fault(f"{at}.support", f"no support '{region.support}'; there are: {', '.join(objects)}")
        elif support.type and (kind := prior.types.get(likeliest(support.type))) is not None and kind.graspable:
            yield _fault(f"{at}.support", f"'{region.support}' can be carried away")
        if region.height_m <= 0.0:
            yield _fault(f"{at}.height_m", f"{region.height_m} is not above 0")
        if region.expected_objects < 0.0:
            yield _fault(f"{at}.expected_objects", f"{region.expected_objects} is below 0")


def _fault(at: str, message: str) -> Fault:
    return Fault("prior", 0, 0, message, at)
