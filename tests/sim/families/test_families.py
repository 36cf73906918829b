"""Random worlds: sane, with an answer that holds when it is looked at again, and told as they are drawn."""

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
from kit.drawn_worlds import DrawnWorld, meet, words, world_of

from skolem.sim.families.compose import drawn
from skolem.sim.families.goals import Description, Property
from skolem.sim.families.margins import MAX_SD, RGB_SD, colour_margin
from skolem.sim.families.ranges import FAMILIES
from skolem.sim.families.writing import scenario_text
from skolem.sim.scenario.models import Certificate, Witness
from skolem.traces.messages.poses import compose2

SEEDS = range(6)  # every variant of the family with most of them
MANY = range(60)
Z = 4.0  # deviations that a sum of draws may be from its mean
each_family = pytest.mark.parametrize("family", sorted(FAMILIES))


def certificate(world: DrawnWorld) -> Certificate:
    assert world.scenario.expect is not None
    assert world.scenario.expect.certificate is not None
    return world.scenario.expect.certificate


# ---------------------------------------------------------------- worlds


@each_family
def test_nothing_overlaps_and_nothing_hangs_over_an_edge(family: str) -> None:
    for seed in SEEDS:
        world = world_of(family, seed)
        assert (seed, world.overlapping(), world.overhanging()) == (seed, [], [])


def test_the_check_of_worlds_tells_what_overlaps_from_what_touches() -> None:
    square = ((0.0, 0.0, 0.3), 0.1, 0.1, 0.0)
    assert meet(square, ((0.0, 0.0, 0.0), 0.0, 0.0, 0.05))
    assert not meet(square, ((*compose2(square[0], (0.15, 0.0, 0.0))[:2], 0.0), 0.0, 0.0, 0.05))
    assert meet(square, ((*compose2(square[0], (0.149, 0.0, 0.0))[:2], 0.0), 0.0, 0.0, 0.05))
    assert not meet(square, ((*compose2(square[0], (0.14, 0.14, 0.0))[:2], 0.0), 0.0, 0.0, 0.05))


def test_the_same_family_and_seed_give_the_same_bytes_in_another_process() -> None:
    code = (
        "import sys; from kit.drawn_worlds import words; from skolem.sim.families.writing import scenario_text; "
        "sys.stdout.write(''.join(scenario_text(family, 3, words()) for family in sys.argv[1:]))"
    )
    env = os.environ | {"PYTHONHASHSEED": "77", "PYTHONPATH": str(Path(__file__).parents[2])}
    command = [sys.executable, "-c", code, *FAMILIES]
    done = subprocess.run(command, capture_output=True, text=True, env=env, check=True)
    assert done.stdout == "".join(scenario_text(family, 3, words()) for family in FAMILIES)


@each_family
def test_seeds_give_different_worlds(family: str) -> None:
    assert len({scenario_text(family, seed, words()).partition("\ngoal:")[2] for seed in SEEDS}) == len(SEEDS)


def test_a_bound_replaces_the_drawn_one_and_nothing_else() -> None:
    drawn, bounded = scenario_text("three", 4, words()), scenario_text("three", 4, words(), 0.98)
    changed = [(a, b) for a, b in zip(drawn.splitlines(), bounded.splitlines(), strict=True) if a != b]
    assert [", o), 0.98)" in line for _, line in changed] == [True]


# ---------------------------------------------------------------- answers


@each_family
def test_the_goal_is_true_once_the_witnesses_are_where_the_certificate_puts_them(family: str) -> None:
    for seed in SEEDS:
        world = world_of(family, seed)
        answer = certificate(world)
        if answer.impossible is None:
            places = {w.thing: (w.on or _target(world, w), w.room) for w in answer.witnesses if w.room is not None}
            cleared = frozenset(name for w in answer.witnesses for name in w.cleared) - set(places)
            assert world.true_if(places, cleared), (family, seed)


def _target(world: DrawnWorld, witness: Witness) -> str:
    text = world.scenario.goal
    return text.partition(f"On({witness.variable}, ")[2].partition(")")[0]


@each_family
def test_a_base_can_stand_where_the_certificate_says_and_an_arm_reaches_from_there(family: str) -> None:
    for seed in SEEDS:
        world = world_of(family, seed)
        for witness in certificate(world).witnesses:
            stand = (witness.stand.x, witness.stand.y, witness.stand.theta)
            assert world.base_fits(stand)
            assert world.arm_reaches(world.item(witness.thing), stand), (family, seed, witness.thing)
            assert all(world.setup.types[world.item(name).type].graspable for name in witness.cleared)


@each_family
def test_witnesses_are_as_described_by_the_margin_of_their_family(family: str) -> None:
    for seed in SEEDS:
        variant = FAMILIES[family][seed % len(FAMILIES[family])]
        assert all(w.margin_sd >= variant.margin_sd[0] for w in certificate(world_of(family, seed)).witnesses)


@pytest.mark.parametrize("seed", range(9))
def test_an_impossible_goal_is_so_for_the_reason_that_is_given(seed: int) -> None:
    world = world_of("impossible", seed)
    target = world.scenario.goal.rpartition("On(o, ")[2].partition(")")[0]
    fitting = [item for item in world.graspable() if world.true_if({item.id: (target, (0.0, 0.0, 0.0))})]
    why = certificate(world).impossible
    assert (why == "nothing_fits") == (not fitting)
    if why == "nothing_reached":
        assert all(world.stands_near(item) == [] for item in fitting)
    if why == "no_room":
        assert all(world.room_on(target, item.type) == [] for item in fitting)
    assert world.stands_near(world.graspable()[-1]) != [] or why == "nothing_reached"


@each_family
def test_only_the_impossible_family_is_impossible_for_another_reason_than_that_nothing_fits(family: str) -> None:
    found = {certificate(world_of(family, seed)).impossible for seed in SEEDS}
    assert found <= {None, "nothing_fits"} or family in ("impossible", "language")


def test_a_colour_keeps_its_word_within_its_margin_and_loses_it_beyond() -> None:
    border = 90.0 / 360.0  # lime ends, green begins
    near, far = (border + 0.01, 0.9, 0.8), (0.35, 0.9, 0.8)
    assert colour_margin(near, words()) < 2.0 < colour_margin(far, words()) <= MAX_SD
    assert words().colour_of(near) == words().colour_of(far) == "green"
    chroma = 0.9 * 0.8
    assert colour_margin(near, words()) * RGB_SD <= 6 * 0.01 * chroma + RGB_SD / 2


def test_a_description_fits_by_its_weakest_part_and_its_best_alternative() -> None:
    body = ("can", (0.35, 0.9, 0.8), 0.45)
    either = Description(((Property("green"), Property("red")), (Property("heavier_than", 400),)))
    assert either.text() == "(Green(x) | Red(x)) & HeavierThan(x, 400)"
    assert either.fits(body, words())
    assert either.margin(body, words()) == pytest.approx(0.05 * 9.81 / 0.4)
    assert not Description(((Property("soda"),),)).fits(body, words())
    assert Description(((Property("soda"),),)).margin(body, words()) == 0.0


# ---------------------------------------------------------------- what is told


def test_types_are_drawn_from_what_is_told() -> None:
    surplus, variance = 0.0, 0.0
    for seed in MANY:
        world = drawn("clutter", seed, words()).world
        kinds = {thing.id: thing.type for thing in world.things}
        for item in world.prior[len(world.tables) :]:
            share = max(item.types.values())
            kind = max(item.types, key=lambda word: item.types[word])
            surplus += (kinds[item.id] == kind) - share
            variance += share * (1.0 - share)
    assert variance > 20.0
    assert abs(surplus) <= Z * math.sqrt(variance)


def test_as_many_strangers_stand_on_tables_as_the_robot_is_told_to_expect() -> None:
    surplus, expected = 0.0, 0.0
    for seed in MANY:
        world = drawn("three", seed, words()).world
        known = {item.id for item in world.prior}
        surplus += sum(thing.id not in known for thing in world.things)
        expected += sum(world.expected.values())
    assert expected > 30.0
    assert abs(surplus - expected) <= Z * math.sqrt(expected)


def test_places_are_told_right_but_in_the_family_about_wrong_ones_which_says_by_how_much() -> None:
    for family in FAMILIES:
        for seed in SEEDS:
            world = world_of(family, seed)
            off = certificate(world).off_m
            assert (off > 0.0) == (family == "far" and seed >= 3)
            for told in world.scenario.belief.objects:
                assert (told.like == "world") == (off == 0.0 or world.item(told.id).on is None)
                if told.at is not None:
                    (x, y, _), (u, v, _) = told.at, world.item(told.id).at
                    assert math.hypot(x - u, y - v) == pytest.approx(off, abs=2e-4)


def test_noise_is_what_the_robot_believes_unless_the_file_says_otherwise() -> None:
    for seed in range(4):
        world = world_of("noisy", seed)
        answer, scenario = certificate(world), world.scenario
        believed = scenario.true_noise if scenario.model == "same" else scenario.model
        assert scenario.true_noise.colour.sd_rgb == pytest.approx(0.03 * answer.noise)
        assert believed.colour.sd_rgb == pytest.approx(0.03 * (answer.noise if answer.noise_told else 1.0))


def test_what_somebody_moves_goes_where_nothing_stands_or_will_stand() -> None:
    for seed in range(12):
        world = world_of("disturbed", seed)
        moves = world.scenario.disturbances
        assert moves
        shapes = [(move.on, world.shape(world.item(move.id).type, move.at)) for move in moves]
        shapes += [(item.on, world.shape(item.type, item.at)) for item in world.graspable()]
        for i, (on, shape) in enumerate(shapes):
            assert not any(on == other_on and meet(shape, other) for other_on, other in shapes[:i])
