"""The text of a scenario file for a drawn world, with comments."""

from collections.abc import Iterable, Iterator, Mapping

from skolem.sim.families.bodies import CROWD, MEDIAN_KG, SIGMA, STRANGERS
from skolem.sim.families.certificate import Witness
from skolem.sim.families.compose import Drawn, drawn
from skolem.sim.families.goals import goal_text
from skolem.sim.families.ranges import Variant
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.sim.families.world import PriorThing
from skolem.traces.messages import RunStatus

NOISE: Mapping[str, Mapping[str, float]] = {  # of the simulated sensors and wheels
    "depth": {"sd_scale": 1.0},
    "extrinsics": {"sd_m": 0.003, "sd_rad": 0.004},
    "detection": {"found": 0.90, "false_per_look": 0.1, "type_right": 0.95},
    "colour": {"gain": 0.83, "sd_rgb": 0.03},
    "odometry": {"sd_m": 0.005, "sd_per_m": 0.02, "sd_rad": 0.01, "sd_per_rad": 0.02},
    "wrist": {"sd_newton": 0.40, "drift_newton": 0.05},
    "grasp": {"sd_m": 0.006, "sd_rad": 0.05},
    "place": {"sd_m": 0.003, "sd_rad": 0.03},
}
SCALED = "sd"  # keys that begin so, or with `drift`, are standard deviations, to which a family's factor applies
PRIOR_HUE = (0.5, 0.5)  # mean and standard deviation
COMMENT_AT = 43  # column of comments


def scenario_text(family: str, seed: int, words: Words, bound: float | None = None) -> str:
    """Return the scenario of a family and a seed.

    Args:
        family: One of `ranges.FAMILIES`.
        seed: Any number from 0.
        words: The vocabulary.
        bound: Bound of the denotations, instead of a drawn one.
    """
    made = drawn(family, seed, words, bound)
    return "\n".join([*_head(made), *_prior_in_general(made), *_truth(made), *_belief(made), *_expect(made), ""])


def _head(made: Drawn) -> Iterator[str]:
    world, variant = made.world, made.world.variant
    yield "# yaml-language-server: $schema=scenario.schema.json"
    yield f"# Drawn by `skolem generate {world.family} --seed {world.seed}`; docs/families.md has the ranges."
    yield _said("skolem: 1", "version of this format")
    yield f"name: {world.family}"
    yield f"about: {variant.about}"
    yield ""
    yield f"goal: {_goal(made)}"
    yield ""
    yield _said(f"seed: {world.seed}", "of the world and of every draw of the run")
    yield ""
    yield "limits:"
    yield _said(f"  steps: {variant.steps}", "executed actions")
    yield "  expansions: 2000"
    yield "  hierarchy_depth: 16"
    yield "  min_plan_probability: 1.0e-4"
    yield ""


def _prior_in_general(made: Drawn) -> Iterator[str]:
    variant = made.world.variant
    hue, sd = PRIOR_HUE if variant.prior_hue is None else variant.prior_hue
    wrong = variant.prior_median != 1.0
    yield _said("priors:", "of an arbitrary object not seen yet")
    yield _said(
        f"  log_weight: {{median_kg: {_n(variant.prior_median * MEDIAN_KG)}, sigma: {_n(SIGMA)}}}",
        f"wrong: things are drawn with a median of {_n(MEDIAN_KG)}" if wrong else "",
    )
    yield _said(
        f"  colour: {{hsv: [{_n(hue)}, 0.6, 0.6], sd: [{_n(sd)}, 0.3, 0.3]}}",
        "wrong: every hue is as likely" if variant.prior_hue is not None else "",
    )
    yield f"  type: {_shares(CROWD if variant.layout == 'crowd' else STRANGERS)}"
    yield ""
    factor = f"{variant.noise:g} times the usual deviations" if variant.noise != 1.0 else "of sensors and wheels"
    yield _said("noise:", factor)
    yield from _noise(variant.noise)
    if variant.model_told:
        yield _said("model: same", "what the robot believes of the noise")
    else:
        yield _said("model:", f"wrong: the truth is {variant.noise:g} times as much")
        yield from _noise(1.0)
    yield ""


def _noise(factor: float) -> Iterator[str]:
    for source, numbers in NOISE.items():
        scaled = (
            f"{name}: {_n(value * (factor if name.startswith((SCALED, 'drift')) else 1.0))}"
            for name, value in numbers.items()
        )
        yield f"  {source}: {{{', '.join(scaled)}}}"


def _truth(made: Drawn) -> Iterator[str]:
    world = made.world
    yield "robot:"
    yield "  base: {x: 0.0, y: 0.0, theta: 0.0}"
    yield "  base_sd: {xy_m: 0.01, theta_rad: 0.01}"
    yield "  torso_m: 0.20"
    yield ""
    yield _said("world:", "the truth: only the simulator reads it")
    known = {each.id for each in world.prior}
    for thing in [*world.tables, *world.things]:
        yield f"  - {_thing(thing)}" + ("" if thing.id in known else "  # nobody told of it")
    if world.moves:
        yield ""
        yield _said("disturbances:", "somebody moves things while the robot does not look")
        for move in world.moves:
            yield f"  - {{before_step: {move.before_step}, id: {move.id}, on: {move.on}, at: {_list(move.at)}}}"
    yield ""


def _thing(thing: Thing) -> str:
    parts = [f"id: {thing.id}", f"type: {thing.type}"]
    parts += [] if thing.on is None else [f"on: {thing.on}"]
    parts += [f"at: {_list(thing.at)}"]
    parts += [] if thing.hsv is None or thing.kg is None else [f"hsv: {_list(thing.hsv)}", f"kg: {_n(thing.kg)}"]
    return f"{{{', '.join(parts)}}}"


def _belief(made: Drawn) -> Iterator[str]:
    world = made.world
    yield _said("belief:", "what the robot is told")
    yield "  defaults: {sd_xy_m: 0.03, sd_theta_rad: 0.10}"
    yield "  objects:" + ("" if world.prior else " []")
    for item in world.prior:
        yield f"    - {_prior(item)}" + _wrong(item, world.variant)
    regions = [(name, expected) for name, expected in world.expected.items()]
    if regions:
        yield "  regions:  # how many objects that nobody told of are expected above each table"
    for i, (name, expected) in enumerate(regions):
        yield f"    - {{id: _reg{i + 1}_, on: {name}, height_m: 0.3, objects: {_n(expected)}}}"
    yield ""


def _prior(item: PriorThing) -> str:
    parts = [f"id: {item.id}", f"type: {_shares(item.types)}"]
    parts += ["like: world"] if item.at is None else [f"on: {item.on}", f"at: {_list(item.at)}"]
    parts += [] if item.sd_xy_m is None else [f"sd_xy_m: {_n(item.sd_xy_m)}"]
    parts += [] if item.sd_theta_rad is None else [f"sd_theta_rad: {_n(item.sd_theta_rad)}"]
    return f"{{{', '.join(parts)}}}"


def _wrong(item: PriorThing, variant: Variant) -> str:
    return "" if item.at is None else f"  # wrong by {_n(variant.off_m)} m"


def _expect(made: Drawn) -> Iterator[str]:
    world, variant, answer = made.world, made.world.variant, made.certificate
    yield _said("expect:", "the known answer; the robot never reads it")
    yield f"  status: {_status(made)}"
    yield "  certificate:"
    yield f"    family: {world.family}"
    yield f"    variant: {variant.name}"
    yield f"    seed: {world.seed}"
    yield _said(f"    retries: {made.retries}", "attempts whose things found no place, or whose answer was not shown")
    if variant.off_m:
        yield f"    off_m: {_n(variant.off_m)}"
    if variant.noise != 1.0:
        yield f"    noise: {_n(variant.noise)}"
        yield f"    noise_told: {str(variant.model_told).lower()}"
    if answer.impossible is not None:
        yield f"    impossible: {answer.impossible}"
    if answer.witnesses:
        yield "    witnesses:"
    for witness in answer.witnesses:
        yield from _witness(witness)


def _witness(witness: Witness) -> Iterator[str]:
    x, y, theta = witness.stand
    yield f"      - variable: {witness.variable}"
    yield f"        thing: {witness.thing}"
    yield _said(f"        margin_sd: {_n(witness.margin_sd)}", "deviations of one reading from not fitting")
    yield _said(f"        stand: {{x: {_n(x)}, y: {_n(y)}, theta: {_n(theta)}}}", "of the base, to reach it")
    if witness.cleared:
        yield _said(f"        cleared: [{', '.join(witness.cleared)}]", "what is put aside before")
    if witness.room is not None:
        said = "the goal's table" if witness.on is None else "that table"
        if witness.on is not None:
            yield _said(f"        on: {witness.on}", "the table to which it is put")
        yield _said(f"        room: {_list(witness.room)}", f"a free place on {said}")


def _goal(made: Drawn) -> str:
    world = made.world
    if world.sentence is not None:
        return world.sentence.text(world.bound, world.placed)
    return goal_text(world.clauses, world.bound, world.placed)


def _status(made: Drawn) -> RunStatus:
    """Return the status with which a run should end; only `the` presupposes that there is one such object."""
    why, sentence = made.certificate.impossible, made.world.sentence
    if why is None:
        return "goal_achieved"
    if sentence is not None and sentence.construct == "the":
        return "no_referent" if why == "nothing_fits" else "no_unique_referent"
    return "goal_unachievable"


def _said(text: str, comment: str) -> str:
    """Return a line with a comment, which begins at column `COMMENT_AT` if the line is short enough."""
    return f"{text.ljust(COMMENT_AT - 1)}  # {comment}" if comment else text


def _shares(shares: Mapping[str, float]) -> str:
    return f"{{{', '.join(f'{kind}: {_n(share)}' for kind, share in shares.items())}}}"


def _list(numbers: Iterable[float]) -> str:
    return f"[{', '.join(map(_n, numbers))}]"


def _n(number: float) -> str:
    """Return a number with at most four digits after the point, and at least one."""
    text = f"{number:.4f}".rstrip("0")
    return text + "0" if text.endswith(".") else text
