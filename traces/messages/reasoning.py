"""Plans, decisions, questions and memory of the reasoner."""

from typing import Final, Literal

from pydantic import Field

from skolem.traces.messages.actions import Command
from skolem.traces.messages.base import Anchor, Message, MicroNats, Probability, StepNumber


class PlanStep(Message):
    """One step of a plan on the stack."""

    op: str
    level: int
    concrete: int = Field(description="the level at which every precondition is demanded")
    primitive: bool = Field(description="carried out by the robot; false: an inference")
    cost: MicroNats
    subgoal: tuple[str, ...] = Field(description="fluents to hold after the step, sorted")
    preimage: tuple[str, ...] = Field(description="fluents under which the step may be taken, sorted")


PlanCause = Literal[
    "start",
    "refine",
    "skipped_forward",
    "fell_back",
    "preimage_lost",
    "bind_skolem",
    "refused",
    "done",
    "giveup",
]
DROPPED: Final[tuple[PlanCause, ...]] = ("preimage_lost", "refused")  # causes that drop a plan


class Plan(Message):
    """The plan stack, logged whenever it changes."""

    step: StepNumber
    cause: PlanCause
    false_fluents: tuple[str, ...] = Field(default=(), description="which fluents of the lost pre-images are false now")
    layers: tuple[tuple[PlanStep, ...], ...] = Field(description="top first; a layer refines one step of the one above")
    current: tuple[int, ...] = Field(default=(), description="index of the chosen step, per layer")


class RememberedStep(PlanStep):
    """A step with all the reasoner needs to go on with it."""

    instance: str = Field(description="the rule instance itself, as a term")
    called: str = Field(description="the operation it counts as, as a term")
    executes: str | None = Field(description="the primitive that carries it out, as a term; null: an inference")


class Memory(Message):
    """What the reasoner remembers when a decision begins: with the belief, all that the decision depends on."""

    step: StepNumber
    layers: tuple[tuple[RememberedStep, ...], ...] = Field(description="the plan stack, top first")
    current: tuple[int, ...] = Field(description="index of the chosen step, per layer")
    executed: RememberedStep | None = Field(description="the step that was carried out last, if it is yet to be judged")
    failures: dict[str, int] = Field(
        description="how often in a row a command did not do what it should, nor came nearer"
    )
    in_vain: dict[str, int] = Field(default={}, description="the same since the robot last moved, by command")
    nearest: dict[str, float] = Field(
        default={}, description="how near a fluent came to being true after a command, at most (see Situation.degree)"
    )
    objections: dict[str, str] = Field(
        default={}, description="why the robot cannot do such a step at all, by instance"
    )


class Candidate(Message):
    """A rule instance offered at the first expansion of a search, or rejected there."""

    op: str
    cost: MicroNats
    rejected: str | None = Field(default=None, description="reason code and the fluent that caused it; null: offered")


class Decision(Message):
    """One search: what was asked, what was offered, what was chosen and what it took."""

    step: StepNumber
    belief_version: int
    subgoal: tuple[str, ...]
    candidates: tuple[Candidate, ...] = Field(description="sorted by (cost, op)")
    plan: tuple[str, ...] = Field(description="operators in execution order; empty: no plan")
    cost: MicroNats
    within: float | None = Field(
        default=None, description="at most this many times the cost of the best plan; 1: optimal; null: not known"
    )
    expansions: int
    clingo_calls: int
    ground_atoms: int


class Denotation(Message):
    """Whom the robot takes to be meant, at each decision."""

    step: StepNumber
    probability: dict[str, dict[Anchor, Probability]] = Field(
        description="P(Den) by description of the goal (e1, e2, ..), then by anchor"
    )


class Geometry(Message):
    """One geometric question and its answer."""

    step: StepNumber
    query: str
    belief_version: int
    answer: Command | None = None
    blockers: tuple[Anchor, ...] | None = Field(default=None, description="of a question what stands in the way")
    tried: int = Field(
        default=0, description="of a drive not found: stances tried until the budget was spent; 0: shown"
    )
