"""An explanation as a tree of lines."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from skolem.reasoner.planning.instances import title
from skolem.reasoner.terms import CAP_MICRONATS, MICRO, parse_term, prob
from skolem.tools.explain.actions import LayerView, Link
from skolem.tools.explain.drops import Drop
from skolem.tools.explain.end import Ending
from skolem.tools.explain.insight import Truth
from skolem.tools.explain.objects import Choice, Option
from skolem.tools.explain.regions import RegionOption
from skolem.tools.words.optimality import optimality
from skolem.tools.words.printable import printable
from skolem.traces.messages.fluents import readable


@dataclass(slots=True)
class Tree:
    """A line and what belongs below it."""

    line: str
    below: list["Tree"] = field(default_factory=list)

    def add(self, line: str) -> "Tree":
        """Add a line below this one and return it."""
        self.below.append(Tree(line))
        return self.below[-1]


def lines(tree: Tree, first: str = "", rest: str = "") -> Iterator[str]:
    """Yield a tree as text with branches."""
    yield first + printable(tree.line)
    for i, below in enumerate(tree.below):
        last = i == len(tree.below) - 1
        yield from lines(below, rest + ("└─ " if last else "├─ "), rest + ("   " if last else "│  "))


def choice_tree(choice: Choice) -> Tree:
    """Return why this object."""
    meant = ", ".join(f"{name} is {text}" for name, text in choice.descriptions.items())
    tree = Tree(f"why this object (chosen at step {choice.step}{'; ' + meant if meant else ''})")
    for option in choice.options:
        _option(tree, option)
    return tree


def _option(tree: Tree, option: Option) -> None:
    name = "an object not met yet" if option.object.startswith("sk(") else option.object
    head = f"{name}: {'chosen' if option.chosen else option.rejected}"
    node = tree.add(head)
    parts = [f"{word} {p:.3f}" for word, p in option.conjuncts.items()]
    parts += [] if option.exists is None else [f"exists {option.exists:.3f}"]
    if parts:
        meant = ", ".join(f"{e} {p:.3f}" for e, p in option.denotes.items())
        node.add(f"meant: {meant or 'named by the goal'}  ({', '.join(parts)})")
    for fluent in option.fluents:
        node.add(truth_text(fluent))
    if option.plan:
        node.add(f"plan, p = {option.probability:.3g}: {'; '.join(option.plan)}")
    for refusal in option.refused[:5]:
        node.add(f"not used: {refusal}")
    for region in option.regions:
        _region(node, region)


def _region(tree: Tree, option: RegionOption) -> None:
    node = tree.add(f"in {option.region}: {'chosen' if option.chosen else option.rejected}")
    inside = ", ".join(f"{e} {p:.3g}" for e, p in option.exists_in.items())
    cost = f"{option.cost / MICRO:.2f}" if option.cost < CAP_MICRONATS else f"above {CAP_MICRONATS // MICRO}"
    known = f"what it holds is known {option.contents:.3f}"
    node.add(f"exists in it: {inside} (cost {cost} nats); {known}")
    if option.plan:
        node.add(f"plan, p = {option.probability:.3g}: {'; '.join(option.plan)}")


def truth_text(found: Truth, before: float | None = None) -> str:
    """Return how things stand with a fluent in one line."""
    state = {True: "holds", False: "false", None: "not asked in the run"}[found.holds]
    if found.probability is None:
        return f"{readable(found.fluent)}: {state}{'; ' + found.detail if found.detail else ''}"
    was = "" if before is None else f"{before:.3f} -> "
    return f"{readable(found.fluent)}: {state}, p = {was}{found.probability:.3f}"


def action_tree(action: str, layers: Iterable[LayerView]) -> Tree:
    """Return why this action."""
    tree = Tree(f"why {action}")
    for number, layer in enumerate(layers):
        goal = " & ".join(map(readable, layer.goal))
        steps = "; ".join(f"<{s}>" if i == layer.chosen else s for i, s in enumerate(layer.steps))
        node = tree.add(f"plan {number + 1}, made at step {layer.made}, for {goal}")
        node.add(f"{steps}  ({optimality(layer.within)})")
        for link in layer.chain:
            _link(node, link)
    return tree


def _link(tree: Tree, link: Link) -> None:
    rule = link.rule or "bound to an object that the rules did not know when the plan was made"
    node = tree.add(f"{link.op} @{link.level}/{link.concrete} gives {readable(link.achieves)}  [{rule}]")
    by = f"{link.needed_by} needs it  [{link.need_rule or 'as above'}]" if link.needed_by else "the goal of this plan"
    node.add(f"wanted: {by}")
    for reason, cost, place in link.costs:
        node.add(f"cost: {reason}, p = {prob(cost):.3f}  [{place}]")
    if link.answers:
        node.add(f"asked: {', '.join(link.answers)}")


def drop_tree(drops: Iterable[Drop]) -> Tree:
    """Return why plans were dropped."""
    tree = Tree("why plans were dropped")
    for drop in drops:
        if drop.cause == "refused":
            names = [title(parse_term(drop.refused[0])), *map(readable, drop.refused[1:])]
            tree.add(f"could not be planned in detail, or not be done: {', '.join(names)}")
            continue
        node = tree.add(f"plan {drop.layer + 1} ({'; '.join(drop.steps)}): no step of it can be taken")
        if drop.after:
            seen = node.add(f"after {drop.after}: {drop.sensed}")
            for change in drop.changed:
                seen.add(change)
        for lost in drop.lost:
            at = node.add(f"{lost.op}")
            for found, before in zip(lost.fluents, lost.before, strict=True):
                at.add(truth_text(found, before))
    return tree


def end_tree(ending: Ending) -> Tree:
    """Return why a run ended without success."""
    tree = Tree(f"why the run ended: {ending.status}: {ending.reason}")
    for remedy in ending.remedies:
        tree.add(remedy.finding).add(f"would have to change: {remedy.change}")
    return tree
