"""Whether a prior makes sense, beyond the types of its fields."""

from collections.abc import Iterator

from skolem.estimation.pose_graph import BASE
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import Prior


def check_prior(prior: Prior) -> None:
    """Check a prior.

    Raises:
        InputError: With every fault.
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
    if not any(kind.graspable for kind in prior.types.values()):
        yield _fault("types", "none is graspable, so nothing can be detected")
    if prior.noise.colour_gain <= 0.0:
        yield _fault("noise.colour_gain", f"{prior.noise.colour_gain} is not above 0")


def _fault(at: str, message: str) -> Fault:
    return Fault("prior", 0, 0, message, at)
