"""Descriptions by a relation: which relation, what is said of either object, and which descriptions are no such."""

import pytest
from kit.relation_tables import WORDS

from skolem.reasoner.language.parser import parse_lambda
from skolem.reasoner.meaning.related import related


@pytest.mark.parametrize(
    ("text", "relation", "from_witness", "itself", "witness"),
    [
        (
            "lambda x. Soda(x) & exists y. (Bottle(y) & Near(x, y) & x != y)",
            "near",
            False,
            "lambda x. Soda(x)",
            "lambda y. Bottle(y)",
        ),
        ("lambda x. exists y. (On(y, x) & Green(y))", "on", True, "None", "lambda y. Green(y)"),
        ("lambda x. Soda(x) & Green(x) & exists y. On(x, y)", "on", False, "lambda x. Soda(x) & Green(x)", "None"),
    ],
)
def test_a_description_by_a_relation_is_taken_apart(
    text: str, relation: str, from_witness: bool, itself: str, witness: str
) -> None:
    found = related(parse_lambda(text, WORDS))
    assert found is not None
    assert (found.relation, found.from_witness) == (relation, from_witness)
    assert (str(found.itself), str(found.witness)) == (itself, witness)


@pytest.mark.parametrize(
    "text",
    [
        "lambda x. Soda(x)",
        "lambda x. Soda(x) & On(x, table1)",
        "lambda x. exists y. Green(y)",
        "lambda x. not exists y. Near(x, y)",
        "lambda x. exists y. (Near(x, y) & On(x, y))",
        "lambda x. exists y. (Near(x, y) & (Green(y) | Soda(x)))",
        "lambda x. (exists y. Near(x, y)) & (exists z. On(x, z))",
    ],
)
def test_other_descriptions_are_left_alone(text: str) -> None:
    assert related(parse_lambda(text, WORDS)) is None
