"""Values that a person need not state: those of the first scenario. A file must still hold what it always held."""

import json

import pytest
from kit.places import ROOT
from pydantic import ValidationError

from skolem.reasoner import load_rules
from skolem.sim import load_scenario
from skolem.traces.file.codec import schema_bytes
from skolem.traces.messages import Limits, NoiseModel

GREEN = ROOT / "scenarios" / "sim1_green.yaml"


def test_defaults_are_the_values_of_the_first_scenario() -> None:
    scenario = load_scenario(GREEN, load_rules().vocabulary.types)
    assert Limits() == scenario.limits
    assert NoiseModel() == scenario.true_noise.message()


def test_a_default_is_replaced_by_name_and_judged_as_before() -> None:
    assert (NoiseModel(found=0.5).found, NoiseModel(found=0.5).type_right) == (0.5, 0.95)
    with pytest.raises(ValidationError, match="steps"):
        Limits(steps=0)


def test_the_schema_of_a_recorded_prior_requires_every_number_of_the_noise() -> None:
    noise = json.loads(schema_bytes("/prior"))["$defs"]["NoiseModel"]
    assert noise["required"] == list(NoiseModel.model_fields)
    assert not [field for field in noise["properties"].values() if "default" in field]
