"""Why this action: the plans on the stack, each with the rules that lead from its goal down to the chosen step."""

from collections.abc import Sequence
from dataclasses import dataclass

from skolem.reasoner.planning.instances import title
from skolem.reasoner.planning.patterns import entails
from skolem.reasoner.planning.proofs import Derivation, Proof, rules_used
from skolem.reasoner.terms import Compound, Term, parse_term
from skolem.tools.explain.insight import Insight, Layer
from skolem.traces.messages import RememberedStep


@dataclass(frozen=True, slots=True)
class Link:
    """A step with the fluent that it achieves, and the step that needs this fluent.

    Attributes:
        op: The step.
        level: Its level, up to `concrete`.
        concrete: The level at which it can be carried out.
        achieves: The fluent that it achieves.
        rule: The rule by which it does so, `look.lp:19`; empty if the rules do not derive it in this belief.
        needed_by: The step that needs the fluent; empty if the plan's goal does.
        need_rule: The rule by which that step needs it; empty in the same case.
        costs: -ln p in micro-nats, by reason, with the rule.
        answers: The questions of the rules to the belief, with the answers.
        rules: Every rule of the derivation, by its place.
    """

    op: str
    level: int
    concrete: int
    achieves: str
    rule: str
    needed_by: str
    need_rule: str
    costs: tuple[tuple[str, int, str], ...] = ()
    answers: tuple[str, ...] = ()
    rules: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class LayerView:
    """One plan on the stack.

    Attributes:
        made: The decision at which it was made.
        within: Bound on its cost as a multiple of the best plan's cost; 1: it is the best; None: no bound is known.
        goal: The subgoal of the plan.
        steps: Its steps, in execution order.
        chosen: Index of the step to take.
        chain: The links from the chosen step up to the goal.
    """

    made: int
    within: float | None
    goal: tuple[str, ...]
    steps: tuple[str, ...]
    chosen: int
    chain: tuple[Link, ...] = ()


class Rules:
    """The derivations of the rules in the belief in which a plan was made."""

    def __init__(self) -> None:
        """Start without a belief."""
        self._known: dict[tuple[int, Term], Derivation] = {}
        self._insight: Insight | None = None

    def enter(self, insight: Insight) -> None:
        """Use this belief from now on."""
        self._insight = insight

    def of(self, fluent: Term) -> Derivation:
        """Return the derivation of the rules for a fluent, in the present belief."""
        assert self._insight is not None, "a belief is entered first"
        key = (self._insight.step, fluent)
        if key not in self._known:
            self._known[key] = self._insight.derivation(fluent)
        return self._known[key]


def view(layer: Layer, chosen: int, made: int, within: float | None, rules: Rules) -> LayerView:
    """Return a plan of the stack, explained in the belief in which it was made."""
    steps = tuple(title(parse_term(step.called)) for step in layer)
    return LayerView(made, within, layer[-1].subgoal, steps, chosen, tuple(_chain(layer, chosen, rules)))


def _chain(layer: Layer, start: int, rules: Rules) -> Sequence[Link]:
    """Return the links from a step to the goal of its plan: each fluent, the step that needs it, and so on."""
    links: list[Link] = []
    at: int | None = start
    while at is not None and (gained := _gained(layer[at])):
        ways = [(not _results(layer[at], f, [f], rules), _needer(layer, at, f), f) for f in gained]
        _, needer, fluent = min(ways, key=lambda way: (way[0], way[1] is None, way[1] or 0, way[2]))
        links.append(_link(layer, at, fluent, needer, rules))
        at = needer
    return links


def _gained(step: RememberedStep) -> list[str]:
    """Return the fluents that a step makes true for its subgoal."""
    return [fluent for fluent in step.subgoal if fluent not in step.preimage]


def _needer(layer: Layer, at: int, fluent: str) -> int | None:
    """Return the next step that has the fluent as a precondition; None if the plan's goal has it."""
    later = range(at + 1, len(layer))
    return next((k for k in later if fluent in layer[k].preimage and fluent not in layer[k].subgoal), None)


def _link(layer: Layer, at: int, fluent: str, needer: int | None, rules: Rules) -> Link:
    step = layer[at]
    results = _results(step, fluent, [fluent, *_gained(step)], rules)
    costs = _of_step(step, "cost", _gained(step), rules)
    needs = [] if needer is None else _needs(layer[needer], fluent, rules)
    proofs = [*results[:1], *costs, *needs[:1]]
    return Link(
        op=title(parse_term(step.called)),
        level=step.level,
        concrete=step.concrete,
        achieves=fluent,
        rule=results[0].place if results else "",
        needed_by="" if needer is None else title(parse_term(layer[needer].called)),
        need_rule=needs[0].place if needs else "",
        costs=tuple((str(_argument(p, 1)), _cost(p), p.place) for p in costs),
        answers=tuple(dict.fromkeys(answer for p in [*results[:1], *costs] for answer in _answers(p))),
        rules=tuple(dict.fromkeys(place for p in proofs for place in rules_used(p))),
    )


def _results(step: RememberedStep, fluent: str, asked: Sequence[str], rules: Rules) -> list[Proof]:
    """Return the derivations by which a step achieves a fluent, if the rules are asked for the fluents `asked`."""
    wanted = parse_term(fluent)
    return [proof for proof in _of_step(step, "result", asked, rules) if entails(_argument(proof, 1), wanted)]


def _needs(step: RememberedStep, fluent: str, rules: Rules) -> list[Proof]:
    """Return the derivations by which a step needs a fluent."""
    given = parse_term(fluent)
    return [proof for proof in _of_step(step, "precond", _gained(step), rules) if entails(given, _argument(proof, 1))]


def _of_step(step: RememberedStep, part: str, asked: Sequence[str], rules: Rules) -> list[Proof]:
    """Return the derivations of all atoms of one kind about a step, each once."""
    instance, arity = parse_term(step.instance), 2 if part == "result" else 3
    derivations = [rules.of(parse_term(fluent)) for fluent in dict.fromkeys(asked)]
    found = {a: d.proof(a) for d in reversed(derivations) for a in d.atoms(part, arity) if a.args[0] == instance}
    return [found[atom] for atom in sorted(found, key=str)]


def _argument(proof: Proof, index: int) -> Term:
    assert isinstance(proof.atom, Compound)
    return proof.atom.args[index]


def _cost(proof: Proof) -> int:
    cost = _argument(proof, 2)
    return cost if isinstance(cost, int) else 0


def _answers(proof: Proof) -> list[str]:
    """Return the queries inside a derivation, with their answers."""
    match proof.atom:
        case Compound("=", (question, answer)):
            return [f"@{question} = {answer}"]
    return [text for premise in proof.premises for text in _answers(premise)]
