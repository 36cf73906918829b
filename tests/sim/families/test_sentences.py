"""The family of goals beyond lambda: what is drawn, what is true of it, and how its runs should end."""

import pytest
from kit.drawn_worlds import DrawnWorld, words, world_of

from skolem.sim.families.compose import Drawn, drawn
from skolem.sim.families.goals import Description, Property
from skolem.sim.families.ranges import FAMILIES, Construct
from skolem.sim.families.sentences import Sentence
from skolem.sim.families.things import Thing

CONSTRUCTS = [variant.name for variant in FAMILIES["language"]]
SEEDS = range(len(CONSTRUCTS) * 12)
CAN = Description(((Property("can"),),))
RED, GREEN = (0.99, 0.9, 0.8), (0.35, 0.9, 0.8)


def made(seed: int) -> Drawn:
    return drawn("language", seed, words())


def sentence_of(answer: Drawn) -> Sentence:
    assert answer.world.sentence is not None
    return answer.world.sentence


def status(world: DrawnWorld) -> str:
    assert world.scenario.expect is not None
    return world.scenario.expect.status


@pytest.mark.parametrize("seed", SEEDS)
def test_a_goal_is_true_by_counting_where_it_is_true_by_the_rules(seed: int) -> None:
    answer, world = made(seed), world_of("language", seed)
    sentence, things = sentence_of(answer), answer.world.things
    assert sentence.true(things, words()) == world.true_if({})
    for table in (table.id for table in answer.world.tables):
        free = (0.0, 0.0, 0.0)
        places = {thing.id: (table, free) for thing in things}
        moved = [Thing(t.id, t.type, table, free, t.hsv, t.kg) for t in things]
        assert sentence.true(moved, words()) == world.true_if(places), table


@pytest.mark.parametrize("construct", CONSTRUCTS)
def test_each_construct_has_worlds_in_which_its_goal_can_be_achieved_and_worlds_in_which_it_cannot(
    construct: Construct,
) -> None:
    first = CONSTRUCTS.index(construct)
    found = {status(world_of("language", seed)) for seed in SEEDS[first :: len(CONSTRUCTS)]}
    fails = {"the": {"no_referent", "no_unique_referent"}, "every": set()}.get(construct, {"goal_unachievable"})
    assert found == {"goal_achieved"} | fails


@pytest.mark.parametrize("seed", SEEDS)
def test_a_goal_that_cannot_be_achieved_is_false_wherever_the_things_are_put(seed: int) -> None:
    answer = made(seed)
    if answer.certificate.impossible is not None:
        sentence = sentence_of(answer)
        for on in range(2 ** len(answer.world.things)):
            put = [
                Thing(t.id, t.type, sentence.target if on >> i & 1 else "another", t.at, t.hsv, t.kg)
                for i, t in enumerate(answer.world.things)
            ]
            assert not sentence.true(put, words())


@pytest.mark.parametrize(
    ("construct", "number", "true"),
    [
        ("not", 1, [1, 2]),
        ("together", 1, [1, 2]),
        ("distinct", 2, [2]),
        ("at_least", 2, [2]),
        ("exactly", 1, [1]),
        ("at_most", 1, [0, 1]),
        ("every", 1, [2]),
        ("not_exists", 1, [0]),
        ("the", 1, []),
    ],
)
def test_truth_depends_on_how_many_of_two_cans_are_on_the_table(
    construct: Construct, number: int, true: list[int]
) -> None:
    sentence = Sentence(construct, CAN, number, "table1")
    for there in range(3):
        things = [
            Thing("a", "can", "table1" if there > 0 else "table2", (0.0, 0.0, 0.0), RED, 0.3),
            Thing("b", "can", "table1" if there > 1 else "table2", (0.0, 0.3, 0.0), GREEN, 0.3),
            Thing("c", "soda", "table1", (0.0, -0.3, 0.0), RED, 0.3),
        ]
        assert sentence.true(things, words()) == (there in true)


def test_the_only_one_is_meant_wherever_others_of_other_kinds_stand() -> None:
    sentence = Sentence("the", Description(((Property("can"),), (Property("green", negated=True),))), 1, "table1")
    things = [
        Thing("a", "can", "table1", (0.0, 0.0, 0.0), RED, 0.3),
        Thing("b", "can", "table1", (0.0, 0.3, 0.0), GREEN, 0.3),
    ]
    assert sentence.text(0.9, 0.8) == "exists o. B(Den(the x. Can(x) & not Green(x), o), 0.9) & B(On(o, table1), 0.8)"
    assert sentence.true(things, words())
    assert not sentence.true([Thing("c", "can", "table2", (0.0, 0.0, 0.0), RED, 0.3), *things], words())


def test_what_follows_alternatives_is_said_of_all_of_them() -> None:
    either = Description(((Property("bottle"), Property("can")),))
    assert Sentence("at_least", either, 2, "table1").text(0.9, 0.8) == (
        "B(at least 2 x. (Bottle(x) | Can(x)) & On(x, table1), 0.9)"
    )
    assert Sentence("exactly", either, 1, None).text(0.9, 0.8) == "B(exactly 1 x. Bottle(x) | Can(x), 0.9)"
