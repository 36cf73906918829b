"""A run as a whole: its limits, its start and its end."""

from typing import Annotated, Literal

from pydantic import Field

from skolem.traces.messages.base import (
    SCHEMA_VERSION,
    TICKS_PER_SECOND,
    Anchor,
    Message,
    Probability,
    StepNumber,
    WorldName,
)


class Limits(Message):
    """Counts after which a run gives up; never seconds."""

    steps: Annotated[int, Field(gt=0, description="executed actions")] = 60
    expansions: Annotated[int, Field(gt=0, description="per call of the regression")] = 2000
    hierarchy_depth: Annotated[int, Field(ge=12, description="layers of the plan stack")] = 16
    min_plan_probability: Probability = 1e-4
    min_plausible: Annotated[
        Probability, Field(description="P that an object is meant, or a region holds such a thing: less is not tried")
    ] = 1e-3
    min_favourable: Annotated[
        Probability, Field(description="chance at least given to one observation, since it can be repeated")
    ] = 0.5
    repeats: Annotated[int, Field(gt=0, description="of one action without success, before it is given up")] = 10
    same_looks: Annotated[int, Field(gt=0, description="in vain from one place, before the next is from elsewhere")] = 3
    plan_changes: Annotated[int, Field(gt=0, description="of the plan stack in one decision")] = 100
    optimal: Annotated[
        bool, Field(description="take more time, so that no plan at all is likelier than the one found")
    ] = False


Evaluation = Literal["worlds", "independent"]


class RunStart(Message):
    """What a run was made of."""

    schema_version: int = SCHEMA_VERSION
    scenario: str
    scenario_sha256: str
    rules_sha256: dict[str, str]
    robot_sha256: str
    world: WorldName
    seed: int
    goal: str
    limits: Limits
    evaluation: Annotated[
        Evaluation | None, Field(description="of beliefs; null in traces from before there was a choice: independent")
    ] = None
    ticks_per_second: int = TICKS_PER_SECOND


class Chain(Message):
    """Hash chain over INPUT and DERIVED messages: equal strings mean that two runs agree up to this step."""

    step: StepNumber
    chain: str


RunStatus = Literal[
    "goal_achieved",
    "goal_unachievable",
    "no_referent",
    "no_unique_referent",
    "limit_reached",
    "error",
    "interrupted",
]


class RunEnd(Message):
    """Why the run ended and what the robot believes of its goal."""

    status: RunStatus
    steps: int
    reason: str
    goal_probability: Probability = Field(description="of the best candidate")
    anchor: Anchor | None = Field(default=None, description="the object that denotes, or the best candidate")
    conjuncts: dict[str, Probability] = Field(default={}, description="of that object: P of each fluent and property")
    regions: dict[str, Probability] = Field(default={}, description="how much of each region has been seen")


class Perf(Message):
    """Wall time by part; the only place where a clock is read."""

    step: StepNumber
    milliseconds: dict[str, float]
