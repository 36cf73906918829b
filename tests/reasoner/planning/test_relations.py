"""Goals that are well formed and cannot be meant: relations of the wrong kinds, bounds out of reach."""

import pytest
from kit.papers import shipped

from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.planning.relations import misused, too_sure

ANCHORS = ("can", "table1")
WIDER = (
    "not {}",
    "Was({})",
    "every y. Soda(y) -> {}",
    "every y. {} -> Soda(y)",
    "at least 2 y. Soda(y) & {}",
)


def faults(goal: str) -> list[str]:
    book = shipped().vocabulary
    return misused(parse_goal(goal, book.words(), ANCHORS), book)


def described(body: str) -> str:
    return f"exists o. B(Den(lambda x. {body}, o), 0.9)"


@pytest.mark.parametrize(
    "body",
    [
        "Soda(x)",
        "HeavierThan(x, 400)",
        "HeavierThan(x, can)",
        "exists y. (HeavierThan(x, y) & Table(y))",
        "On(x, table1) & HeavierThan(x, 400)",
        "exists y. (Near(x, y) & Table(y))",
        "Soda(x) | On(x, table1)",
    ],
)
def test_relations_between_objects_and_comparisons_with_numbers_are_right(body: str) -> None:
    assert faults(described(body)) == []


@pytest.mark.parametrize("around", ["{}", "Soda(x) & {}", "{} | Soda(x)", "exists y. (Soda(y) & {})", *WIDER])
@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("Near(x, x)", "Near is never true of an object and itself; name another one"),
        ("HeavierThan(can, can)", "HeavierThan is never true of an object and itself; name another one"),
        ("Near(x, 400)", "Near is between objects, found the number 400"),
        ("HeavierThan(300, 400)", "HeavierThan is of an object first"),
        ("Near(400, x)", "Near is of an object first"),
    ],
)
def test_a_relation_of_the_wrong_kind_is_found_wherever_it_stands(wrong: str, said: str, around: str) -> None:
    [fault] = faults(described(around.format(wrong)))
    assert fault.endswith(said)


def test_a_relation_of_ones_own_outside_of_a_description_is_refused() -> None:
    [fault] = faults("B(Near(can, table1), 0.9)")
    assert fault.endswith("Near is for descriptions only; write it inside of a lambda")
    assert faults("B(On(can, table1), 0.9)") == []


def test_sentences_and_joint_beliefs_are_looked_through_too() -> None:
    [fault] = faults("B(not exists x. Near(x, x), 0.9)")
    assert "Near is never true of an object and itself" in fault
    [fault] = faults("B(Near(can, table1) & Soda(can), 0.9)")
    assert "Near is for descriptions only" in fault


@pytest.mark.parametrize(
    ("conjunct", "p", "reached"),
    [
        ("B(Soda(can), {})", 0.999, True),
        ("B(On(can, table1), {})", 0.99, True),
        ("B(On(can, table1), {})", 0.999, False),
        ("B(Den(lambda x. Soda(x), can), {})", 0.99, True),
        ("B(Den(lambda x. Soda(x), can), {})", 0.999, False),
        ("B(Soda(can) & Red(can), {})", 0.999, True),
        ("B(Soda(can) & On(can, table1), {})", 0.99, True),
        ("B(Soda(can) & On(can, table1), {})", 0.999, False),
        ("B(Pose(can), any, (0.01, 0.01, 0.05), (0.1, 0.1, 0.1), {})", 0.99, True),
        ("B(Pose(can), any, (0.01, 0.01, 0.05), (0.1, 0.1, 0.1), {})", 0.999, False),
    ],
)
def test_what_needs_the_object_to_exist_is_never_surer_than_that(conjunct: str, p: float, reached: bool) -> None:
    goal = parse_goal(conjunct.format(p), shipped().vocabulary.words(), ANCHORS)
    found = too_sure(goal, 0.99)
    assert [text.partition(": ")[2][:54] for text in found] == (
        [] if reached else ["no object is ever believed to exist with more than 0.9"]
    )
