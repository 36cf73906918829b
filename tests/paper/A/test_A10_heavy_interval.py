"""A10: heavy is an interval of weights."""

import math
from pathlib import Path

import pytest
from kit.papers import shipped, with_own_rules
from kit.searches import table_prior

from skolem.estimation.belief import Belief
from skolem.reasoner.rulebook.book import Rulebook
from skolem.traces.messages import PriorObject


def prob_heavy(grams: float, book: Rulebook) -> float:
    """P(heavy) of an object whose weight is known to a tenth of a gram."""
    thing = PriorObject(
        anchor="o",
        type={"soda": 1.0},
        world_T_object=(1.0, 0.0, 0.7, 0.0),
        sd_xy_m=0.01,
        sd_theta_rad=1.0,
        log_weight=(math.log(grams / 1000.0), (1e-4) ** 2),
    )
    return Belief(table_prior(objects=[thing])).prob_property("o", book.vocabulary.meanings["heavy"])


@pytest.mark.parametrize(("grams", "heavy"), [(399.0, 0.0), (401.0, 1.0), (5000.0, 1.0)])
def test_400_grams_and_more_are_heavy(grams: float, heavy: float) -> None:
    """ "The definition of Heavy is an interval in weight space, objects with a mass of 400 g or greater." """
    assert prob_heavy(grams, shipped()) == pytest.approx(heavy, abs=1e-6)


def test_the_limit_is_a_fact_of_the_vocabulary_and_a_rule_file_of_ones_own_replaces_it(tmp_path: Path) -> None:
    """ "Which for this example is objects with a mass of 400 g or greater." """
    assert "weight(heavy, 400, any)." in shipped().files["vocabulary.lp"].decode()
    mine = with_own_rules(tmp_path, "weight(heavy, 250, any).\n")
    assert (prob_heavy(260.0, mine), prob_heavy(260.0, shipped())) == pytest.approx((1.0, 0.0))
