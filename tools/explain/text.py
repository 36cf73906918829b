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
from skolem.traces.wording.wording import Wording


@dataclass(slots=True)
class Tree:
    """A line with the lines below it."""

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


def choice_tree(choice: Choice, words: Wording) -> Tree:
    """Return why this object."""
    tree = Tree(f"why this object (chosen at step {choice.step}{_descriptions(choice, words)})")
    for option in choice.options:
        _option(tree, option, words)
    for gap in choice.gaps:
        both = f"{gap.worlds:.3f} by possible worlds, {gap.independent:.3f} by the paper's product"
        tree.add(f"{words.meant(gap.expression)} for {gap.object}: {both}; they differ by {gap.size:.3f}")
    return tree


def _descriptions(choice: Choice, words: Wording) -> str:
    """Return the descriptions of the goal, for the end of a line."""
    if words.in_words:
        said = [words.described(name) for name in choice.descriptions]
        return f"; the goal means {' and '.join(said)}" if said else ""
    return "".join(f"; {name} is {text}" for name, text in choice.descriptions.items())


def _option(tree: Tree, option: Option, words: Wording) -> None:
    name = "an object not met yet" if option.object.startswith("sk(") else option.object
    node = tree.add(f"{name}: {'chosen' if option.chosen else words.sentence(option.rejected)}")
    parts = [f"{word} {p:.3f}" for word, p in option.conjuncts.items()]
    parts += [] if option.exists is None else [f"exists {option.exists:.3f}"]
    if parts:
        meant = ", ".join(f"{words.meant(e)} = {p:.3f}" for e, p in option.denotes.items())
        node.add(f"{meant or 'named by the goal'}  ({', '.join(parts)})")
    for fluent in option.fluents:
        node.add(truth_text(fluent, words))
    if option.plan:
        node.add(_plan(option.plan, option.probability, words))
    for refusal in option.refused[:5]:
        op, _, code = refusal.rpartition(": ")
        node.add(f"not possible: {words.operation(op)}: {words.refusal(code)}")
    for region in option.regions:
        _region(node, region, words)


def _plan(steps: Iterable[str], p: float | None, words: Wording) -> str:
    return f"plan, p = {p:.3g}: {'; '.join(map(words.operation, steps))}"


def _region(tree: Tree, option: RegionOption, words: Wording) -> None:
    node = tree.add(f"in {option.region}: {'chosen' if option.chosen else words.sentence(option.rejected)}")
    inside = ", ".join(f"p = {p:.3g} that {words.described(e)} is hidden in it" for e, p in option.exists_in.items())
    cost = f"{option.cost / MICRO:.2f}" if option.cost < CAP_MICRONATS else f"above {CAP_MICRONATS // MICRO}"
    nats = "" if words.in_words else f" (cost {cost} nats)"
    node.add(f"{inside}{nats}; p = {option.contents:.3f} that all it holds is known")
    if option.plan:
        node.add(_plan(option.plan, option.probability, words))


def truth_text(found: Truth, words: Wording, before: float | None = None) -> str:
    """Return the truth of a fluent in one line."""
    state = {True: "true", False: "false", None: "not asked in the run"}[found.holds]
    if found.probability is None:
        return f"{words.fluent(found.fluent)}: {state}{'; ' + found.detail if found.detail else ''}"
    was = "" if before is None else f"{before:.3f} -> "
    return f"{words.fluent(found.fluent)}: {state}, p = {was}{found.probability:.3f}"


def action_tree(action: str, layers: Iterable[LayerView], words: Wording) -> Tree:
    """Return why this action."""
    tree = Tree(f"why {words.operation(action)}" if action else "why no action")
    for number, layer in enumerate(layers):
        steps = map(words.operation, layer.steps)
        marked = "; ".join(f"<{s}>" if i == layer.chosen else s for i, s in enumerate(steps))
        node = tree.add(f"plan {number + 1}, made at step {layer.made}, for {words.aim(layer.goal)}")
        node.add(f"{marked}  ({optimality(layer.within)})")
        for link in layer.chain:
            _link(node, link, words)
    return tree


def _link(tree: Tree, link: Link, words: Wording) -> None:
    """Add a step, its fluent, the step that needs it, and the risk; questions of the rules are shown as recorded."""
    rule = link.rule or "bound to an object that the rules did not know when the plan was made"
    step = f"{words.operation(link.op)} (level {link.level} of {link.concrete})"
    node = tree.add(f"{step} makes true: {words.fluent(link.achieves)}  [{rule}]")
    needer = f"{words.operation(link.needed_by)}  [{link.need_rule or 'as above'}]"
    node.add(f"needed to {needer}" if link.needed_by else "this is the aim of the plan, or a part of it")
    for reason, cost, place in link.costs:
        node.add(f"{words.risk(reason, prob(cost))}  [{place}]")
    if link.answers and not words.in_words:
        node.add(f"asked: {', '.join(link.answers)}")


def drop_tree(drops: Iterable[Drop], words: Wording) -> Tree:
    """Return why plans were dropped."""
    tree = Tree("why plans were dropped")
    for drop in drops:
        if drop.cause == "refused":
            step, *lacking = drop.refused
            needs = f"; it needs that {words.aim(lacking)}" if lacking else ""
            tree.add(f"no way was found to {words.operation(title(parse_term(step)))}{needs}")
            continue
        steps = "; ".join(map(words.operation, drop.steps))
        node = tree.add(f"plan {drop.layer + 1} ({steps}): no step of it can be taken")
        if drop.after:
            seen = node.add(f"after this: {words.operation(drop.after)}; sensed: {drop.sensed}")
            for change in drop.changed:
                seen.add(change)
        for lost in drop.lost:
            at = node.add(f"to {words.operation(lost.op)} it needs:")
            for found, before in zip(lost.fluents, lost.before, strict=True):
                at.add(truth_text(found, words, before))
    return tree


def end_tree(ending: Ending, words: Wording) -> Tree:
    """Return why a run ended without success."""
    tree = Tree(f"why the run ended: {words.ended(ending.status, ending.reason)}")
    for remedy in ending.remedies:
        tree.add(words.sentence(remedy.finding)).add(f"what would help: {words.sentence(remedy.change)}")
    return tree
