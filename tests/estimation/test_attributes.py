import pytest

from skolem.estimation.attributes import TypeBelief, after_evidence, after_miss

THREE = ("bottle", "carton", "soda")


def types(right: float = 0.95, **probabilities: float) -> TypeBelief:
    return TypeBelief(probabilities, THREE, right)


def reading(kind: str) -> dict[str, float]:
    return {name: 0.0 if name == kind else -60.0 for name in THREE}


def test_misses_in_plain_view_and_behind_others_lower_existence_as_they_should() -> None:
    seen, hidden = [0.95], [0.95]
    for _ in range(3):
        seen.append(after_miss(seen[-1], 0.9))
        hidden.append(after_miss(hidden[-1], 0.27))
    assert seen[1:] == pytest.approx([0.655, 0.16, 0.019], abs=1e-3)
    assert hidden[1:] == pytest.approx([0.93, 0.91, 0.88], abs=1e-2)


def test_miss_that_could_not_happen_is_survived_by_what_is_certain() -> None:
    assert after_miss(1.0, 1.0) == 1.0
    assert after_miss(0.5, 1.0) == 0.0


def test_evidence_multiplies_the_odds() -> None:
    assert after_evidence(0.5, 3.0) == pytest.approx(0.75)
    assert after_evidence(after_evidence(0.2, 7.0), 1 / 7.0) == pytest.approx(0.2)


def test_one_favourable_look_lifts_a_type_from_80_to_98_7_percent() -> None:
    belief = TypeBelief({"soda": 0.8, "carton": 0.2}, ("carton", "soda"), 0.95)
    assert belief.updated({"soda": -1.0, "carton": -50.0}).prob("soda") == pytest.approx(0.987, abs=5e-4)


def test_two_looks_at_85_percent_lift_one_of_three_above_90_percent() -> None:
    belief = types(0.85, soda=1 / 3, carton=1 / 3, bottle=1 / 3)
    once = belief.updated(reading("soda"))
    assert once.prob("soda") == pytest.approx(0.85)
    assert once.updated(reading("soda")).prob("soda") > 0.9


def test_reading_of_another_type_lowers_the_type() -> None:
    belief = types(soda=0.8, carton=0.2)
    assert belief.updated(reading("carton")).prob("soda") < 0.2
    assert belief.updated(reading("bottle")).prob("soda") == pytest.approx(0.8)


def test_cluster_that_fits_two_types_equally_tells_them_not_apart() -> None:
    after = types(soda=0.6, carton=0.3, bottle=0.1).updated({"soda": 0.0, "carton": 0.0, "bottle": -60.0})
    assert after.prob("soda") / after.prob("carton") == pytest.approx(2.0)
    assert after.prob("bottle") < 0.1


def test_evidence_of_all_readings_sums_to_one() -> None:
    belief = types(soda=0.6, carton=0.3, bottle=0.1)
    assert sum(belief.evidence(reading(kind)) for kind in THREE) == pytest.approx(1.0)


def test_detector_that_is_always_right_and_contradicts_the_belief_leaves_it() -> None:
    certain = TypeBelief({"soda": 1.0}, THREE, 1.0)
    assert certain.updated(reading("carton")) == certain


def test_chance_of_a_favourable_look_is_that_of_the_readings_that_suffice() -> None:
    belief = types(soda=0.8, carton=0.2)
    assert belief.prob_favourable("soda", 0.95) == pytest.approx(0.95)
    assert belief.prob_favourable("soda", 0.999) == 0.0
    assert belief.prob_favourable("soda", 0.79) == pytest.approx(0.975)  # a wrong reading of a third type keeps .8


def test_most_likely_type_is_the_first_by_name_among_equals() -> None:
    assert types(soda=0.4, bottle=0.4, carton=0.2).most_likely() == "bottle"
