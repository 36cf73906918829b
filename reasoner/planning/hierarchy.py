"""The plan stack: which step to take now, which plans still apply, which are dropped and why.

Layer 0 is a plan for the goal; each further layer is a plan for the subgoal of the step chosen in the layer above, one
abstraction level lower for the operations that are on the stack already (postponed preconditions, Sacerdoti). After
every observation the stack is walked from the top: the last step whose pre-image holds is taken, and layers that do
not apply any more are popped.
"""

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from skolem.reasoner.planning.instances import Instance, title
from skolem.reasoner.planning.regression import Step, Subgoal
from skolem.reasoner.terms import CAP_MICRONATS, Term, substitute
from skolem.traces.messages import Plan, PlanCause, PlanStep

Binding = Mapping[Term, Term]
Satisfied = Callable[[Subgoal], Iterable[Binding]]  # the bindings of Skolem constants under which all fluents hold


@dataclass(frozen=True, slots=True)
class Change:
    """A change of the stack: recorded as the cause of a `Plan` message.

    Attributes:
        cause: What it was.
        false_fluents: What is false now, or the names of the steps that cannot be used.
    """

    cause: PlanCause
    false_fluents: tuple[Term, ...] = ()


class PlanStack:
    """Layers of steps in execution order, and the step chosen in each."""

    def __init__(self, layers: Sequence[Sequence[Step]] = (), chosen: Sequence[int] = ()) -> None:
        """Begin with layers as `steps` returns them; by default with none."""
        self._layers: list[list[Step]] = [list(layer) for layer in layers]
        self._chosen: list[int] = list(chosen)

    def __len__(self) -> int:
        return len(self._layers)

    def steps(self) -> tuple[tuple[tuple[Step, ...], ...], tuple[int, ...]]:
        """Return every layer, top first, and the index of the step chosen in each."""
        return tuple(map(tuple, self._layers)), tuple(self._chosen)

    def push(self, steps: Iterable[Step]) -> None:
        """Add a plan for the step chosen last; its first step is chosen."""
        self._layers.append(list(steps))
        self._chosen.append(0)

    def pop(self) -> None:
        """Drop the lowest plan."""
        self._cut(len(self._layers) - 1)

    def clear(self) -> None:
        """Drop every plan."""
        self._cut(0)

    def current(self) -> Step | None:
        """Return the step chosen in the lowest layer."""
        return self._layers[-1][self._chosen[-1]] if self._layers else None

    def level_of(self, instance: Instance) -> int:
        """Return 1 + the highest level of the same operation among the steps being refined, 0 if there is none."""
        return max((level + 1 for operation, level in self.refined() if operation == instance.operation), default=0)

    def refined(self) -> frozenset[tuple[Term, int]]:
        """Return operation and level of every step being refined: all that `level_of` depends on."""
        chosen = [layer[i] for layer, i in zip(self._layers, self._chosen, strict=True)]
        return frozenset((step.instance.operation, step.level) for step in chosen)

    def select(
        self,
        satisfied: Satisfied,
        false_in: Callable[[Subgoal], list[Term]],
        refused: Callable[[Instance, int], bool] = lambda _instance, _level: False,
    ) -> list[Change]:
        """Choose a step in every layer for the present belief, pop layers that do not apply; return what changed.

        Args:
            satisfied: Returns the bindings of Skolem constants that make a conjunction true now.
            false_in: Returns the fluents of a conjunction that are false now.
            refused: Whether a step cannot be used at a level in this belief. A Skolem constant is not taken to be an
                anchor with which such a step would have to be taken: the plan goes on for another object.
        """
        changes: list[Change] = []
        envelopes = self._envelopes()
        for i, layer in enumerate(self._layers):
            choice = self._last_applicable(i, envelopes[i], satisfied, refused, changes)
            if choice is None:
                lost = sorted({f for step in layer for f in false_in(step.preimage)}, key=str)
                return [*changes, self._popped(i, Change("preimage_lost", tuple(lost)))]
            if choice != self._chosen[i]:
                changes.append(Change("skipped_forward" if choice > self._chosen[i] else "fell_back"))
                self._chosen[i] = choice
                self._cut(i + 1)
                return changes
        return changes

    def _last_applicable(
        self,
        i: int,
        envelopes: list[list[Subgoal]],
        satisfied: Satisfied,
        refused: Callable[[Instance, int], bool],
        changes: list[Change],
    ) -> int | None:
        for j in range(len(self._layers[i]) - 1, -1, -1):
            for binding in itertools.chain.from_iterable(map(satisfied, envelopes[j])):
                if not binding:
                    return j
                if self._bind([*self._chosen[:i], j], binding, refused):
                    changes.append(Change("bind_skolem"))
                    return j
        return None

    def _bind(self, starts: Sequence[int], binding: Binding, refused: Callable[[Instance, int], bool]) -> bool:
        """Replace Skolem constants in the upper layers, in each from one step on, and pop the layers below.

        A layer is a plan for a step of the one above, and remains one, since both are bound alike.

        Returns:
            Whether that was done; it is not if a step could not be used any more.
        """
        old = [layer[start:] for layer, start in zip(self._layers, starts, strict=False)]
        new = [[_bound(step, binding) for step in steps] for steps in old]
        pairs = zip(itertools.chain(*old), itertools.chain(*new), strict=True)
        if any(before != after and refused(after.instance, after.level) for before, after in pairs):
            return False
        self._cut(len(starts))
        for layer, start, steps in zip(self._layers, starts, new, strict=True):
            layer[start:] = steps
        return True

    def _envelopes(self) -> list[list[list[Subgoal]]]:
        """Return per layer and step the conjunctions in any of which the step may go on.

        The pre-image of a step being refined is widened by those of the layer below, so that work in progress (the base
        elsewhere, an object in the hand) does not drop the plan it serves.
        """
        out: list[list[list[Subgoal]]] = [[] for _ in self._layers]
        for i in range(len(self._layers) - 1, -1, -1):
            out[i] = [[step.preimage] for step in self._layers[i]]
            if i + 1 < len(self._layers):
                for lower in out[i + 1]:
                    out[i][self._chosen[i]].extend(lower)
        return out

    def _popped(self, i: int, change: Change) -> Change:
        self._cut(i)
        return change

    def _cut(self, length: int) -> None:
        del self._layers[length:]
        del self._chosen[length:]

    def message(self, step: int, change: Change) -> Plan:
        """Return the stack as it stands, for the trace."""
        return Plan(
            step=step,
            cause=change.cause,
            false_fluents=tuple(map(str, change.false_fluents)),
            layers=tuple(tuple(map(plan_step, layer)) for layer in self._layers),
            current=tuple(self._chosen),
        )


def _bound(step: Step, binding: Binding) -> Step:
    """Return a step with its Skolem constants replaced by the anchors they turned out to be."""

    def apply(term: Term) -> Term:
        return substitute(term, binding)

    instance = step.instance
    return replace(
        step,
        instance=replace(
            instance,
            step=apply(instance.step),
            operation=apply(instance.operation),
            executes=None if instance.executes is None else apply(instance.executes),
        ),
        subgoal=frozenset(map(apply, step.subgoal)),
        preimage=frozenset(map(apply, step.preimage)),
    )


def plan_step(step: Step) -> PlanStep:
    """Return a step as the trace shows it."""
    return PlanStep(
        op=title(step.instance.operation),
        level=step.level,
        concrete=step.instance.concrete,
        primitive=step.instance.executes is not None,
        cost=min(step.instance.price, CAP_MICRONATS),
        subgoal=tuple(sorted(map(str, step.subgoal))),
        preimage=tuple(sorted(map(str, step.preimage))),
    )
