"""The objects of a belief as independent variables, and the relations that may hold between them.

An object is an anchor, one that was overlooked in a region, or a stranger. No atom is true of an object that does not
exist. The strangers of a region with the same properties are a Poisson number, independent of the others, and nothing
but their number is uncertain; so one of them speaks for all.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from math import exp
from typing import Final, Literal, NamedTuple

from skolem.reasoner.protocols import EarlierBeliefs, GroundBeliefs, WorldBeliefs
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.reasoner.worlds.cells import Cells, bits
from skolem.reasoner.worlds.diagrams import FALSE, TRUE, Diagram
from skolem.traces.errors import InternalError
from skolem.traces.messages import Meaning, Relation, Strangers, WeightInterval

SURE: Final = 1e-9  # a relation at most this far from 0 or 1 counts as false or true


@dataclass(frozen=True, slots=True)
class Stranger:
    """One of the strangers of a region with the properties of a cell.

    Attributes:
        region: Number of the region.
        cell: Number of the cell.
        index: Its number among them, from 1.
    """

    region: int
    cell: int
    index: int


Individual = int | Stranger  # the number of a known object, or a stranger
RelationKind = Literal["on", "near", "heavier", "nearer", "weighs"]


class Universe:
    """The objects of a belief as variables of a diagram, and the relations that they may have.

    Attributes:
        diagram: The formulas about them.
        cells: The cells of the words in question.
        names: The anchors, by number.
        uncertain: The relations that are neither sure nor impossible, by number, as `_Asked`.
    """

    def __init__(
        self,
        belief: GroundBeliefs,
        vocabulary: Vocabulary,
        meanings: Mapping[str, Meaning],
        most: int = 0,
        strangers: bool = True,
        compared: bool = False,
    ) -> None:
        """Begin.

        Args:
            belief: The belief.
            vocabulary: The words.
            meanings: The properties in question, by name.
            most: The greatest number of strangers of a kind that is asked for; 0 for no strangers.
            strangers: Whether there may be objects that nobody has met.
            compared: Whether weights are compared, so that a word about a weight is a relation.
        """
        self.diagram, self.cells = Diagram(), Cells.of(meanings)
        self.names = belief.anchors()
        self.uncertain: list[_Asked] = []
        # which pairs are surely related, or not, by what is asked of them
        self._settled: dict[tuple[object, ...], dict[tuple[str, ...], int]] = {}
        self._belief, self.vocabulary, self.meanings = belief, vocabulary, meanings
        self._joint = belief if isinstance(belief, WorldBeliefs) else None
        self.compared = compared and self._joint is not None
        self._relations: dict[_Asked, int] = {}
        self._shares: dict[int, list[float]] = {}  # by mask, of each anchor
        self._numbers = {name: i for i, name in enumerate(self.names)}
        rows = self.cells.table(
            [belief.prob_exists(name) for name in self.names],
            lambda meaning: [belief.prob_property(name, meaning) for name in self.names],
        )
        self._rows = rows
        self._variables = [self.diagram.variable(row) for row in rows.tolist()]
        self.regions: tuple[Strangers, ...] = ()
        self._classes: dict[tuple[int, int], int] = {}  # variable of the number of strangers, by region and cell
        self._supports: dict[int, str] = {}  # of the overlooked objects, by number
        self._most = most
        if strangers and most and self._joint is not None:
            self.regions = self._joint.strangers()
        if self.regions and self._joint is not None:
            self._add_strangers(self._joint, most)

    def _add_strangers(self, belief: WorldBeliefs, most: int) -> None:
        def prob(meaning: Meaning) -> list[float]:
            return [belief.prob_property_of_new(meaning)]

        (share,) = self.cells.table([1.0], prob)
        for region, found in enumerate(self.regions):
            if found.overlooked > 0.0:
                self._supports[len(self._variables)] = found.support
                self._variables.append(self.diagram.variable(*self.cells.table([found.overlooked], prob)))
            for cell, p in enumerate(share):
                if found.expected * p > 0.0:
                    numbers = poisson(found.expected * float(p), most)
                    self._classes[region, cell] = self.diagram.variable(numbers)

    def share(self, anchor: str, mask: int) -> float:
        """Return P(an anchor exists and is in one of the cells of a mask); 0 for an unknown anchor."""
        if mask not in self._shares:
            self._shares[mask] = (self._rows @ bits(mask, self.cells.count)).tolist()
        number = self._numbers.get(anchor)
        return 0.0 if number is None else self._shares[mask][number]

    # ------------------------------------------------------------ objects

    def known(self, name: str) -> int | None:
        """Return the number of an anchor; None for an unknown one."""
        return self._numbers.get(name)

    def objects(self) -> range:
        """Return the numbers of the anchors and the overlooked objects."""
        return range(len(self._variables))

    def classes(self) -> Iterator[tuple[int, int]]:
        """Yield region and cell of each kind of stranger."""
        yield from self._classes

    def exists(self, one: Individual) -> int:
        """Return the formula: the object exists."""
        if isinstance(one, Stranger):
            return self.more_than(one.region, one.cell, one.index - 1)
        return self.diagram.literal(self._variables[one], self.cells.present)

    def more_than(self, region: int, cell: int, number: int) -> int:
        """Return the formula: a region has more than that number of strangers of a kind.

        Raises:
            InternalError: If the number is beyond the greatest one that was stated.
        """
        if number >= self._most:
            raise InternalError(
                f"more than {number} strangers of a kind are asked for; {self._most} were reckoned with"
            )
        return self.diagram.literal(self._classes[region, cell], (1 << self._most + 1) - (1 << number + 1))

    def has(self, one: Individual, name: str) -> int:
        """Return the formula: the object exists and has the property of that name."""
        mask = self.cells.masks[name]
        if isinstance(one, Stranger):
            return self.exists(one) if mask >> one.cell & 1 else FALSE
        meaning = self.meanings[name]
        if self.compared and isinstance(meaning, WeightInterval) and one < len(self.names):
            weighs = self.related("weighs", (self.names[one],), 0.0, meaning)
            return self.diagram.all_of((self.exists(one), weighs))
        return self.diagram.literal(self._variables[one], mask)

    # ------------------------------------------------------------ relations

    def rests(self, one: Individual, support: Individual, earlier: bool = False) -> int:
        """Return the formula: both exist, and the first rests on the second, or did so at the start."""
        if isinstance(support, Stranger) or support >= len(self.names):
            return FALSE
        below = self.names[support]
        if isinstance(one, Stranger) or one >= len(self.names):
            at = self.regions[one.region].support if isinstance(one, Stranger) else self._supports[one]
            return self._both(one, support, TRUE if at == below else FALSE)
        return self._both(one, support, self.related("on", (self.names[one], below), earlier=earlier))

    def beside(self, one: Individual, other: Individual, distance_m: float, earlier: bool = False) -> int | None:
        """Return the formula: both exist and are, or were, near each other; None if that is not known."""
        if one == other:
            return FALSE
        if not self._met(one, other):
            return None
        anchors = (self.names[_number(one)], self.names[_number(other)])
        if self._joint is not None and _number(one) > _number(other):
            anchors = anchors[::-1]
        return self._both(one, other, self.related("near", anchors, distance_m, earlier=earlier))

    def heavier(self, one: Individual, other: Individual) -> int | None:
        """Return the formula: both exist, and the first weighs more; None if that is not known."""
        if one == other:
            return FALSE
        if not self.compared or not self._met(one, other):
            return None
        first, second = _number(one), _number(other)
        found = self.related("heavier", (self.names[min(first, second)], self.names[max(first, second)]))
        return self._both(one, other, found if first < second else self.diagram.negation(found))

    def nearer(self, one: Individual, other: Individual, to: Individual, earlier: bool = False) -> int | None:
        """Return the formula: all exist, and the first is, or was, nearer to the third; None if that is not known."""
        if one == other or other == to:
            return FALSE
        if one == to:
            return self._both(one, other, TRUE)
        if self._joint is None or not self._met(one, other, to):
            return None
        first, second = _number(one), _number(other)
        names = (self.names[min(first, second)], self.names[max(first, second)], self.names[_number(to)])
        found = self.related("nearer", names, earlier=earlier)
        found = found if first < second else self.diagram.negation(found)
        return self.diagram.all_of((self._both(one, other, found), self.exists(to)))

    def _met(self, *objects: Individual) -> bool:
        return all(not isinstance(one, Stranger) and one < len(self.names) for one in objects)

    def _both(self, one: Individual, other: Individual, relation: int) -> int:
        if relation == FALSE:
            return FALSE
        return self.diagram.all_of((self.exists(one), self.exists(other), relation))

    def related(
        self,
        kind: RelationKind,
        anchors: tuple[str, ...],
        distance_m: float = 0.0,
        meaning: WeightInterval | None = None,
        earlier: bool = False,
    ) -> int:
        """Return the formula: the relation holds, or held at the start, between objects that exist."""
        key = _Asked(kind, anchors, distance_m, meaning, earlier)
        if key not in self._relations:
            self._relations[key] = self._related(key)
        return self._relations[key]

    def _related(self, asked: "_Asked") -> int:
        together = asked.kind in ("near", "heavier", "nearer") and self._joint is not None
        p = self._settled_chance(asked) if together else self._prob(asked)
        if p is not None and p <= SURE:
            return FALSE
        if p is not None and p >= 1.0 - SURE:
            return TRUE
        self.uncertain.append(asked)
        if self._joint is not None:
            return self.diagram.relation(len(self.uncertain) - 1)
        assert p is not None
        return self.diagram.literal(self.diagram.variable((1.0 - p, p)), 0b10)

    def _settled_chance(self, asked: "_Asked") -> float | None:
        """Return 0 or 1 if it is sure whether two anchors are related; all pairs are looked at together."""
        to = asked.anchors[2:]
        alike = asked.kind, asked.distance_m, asked.earlier, to
        if alike not in self._settled:
            assert self._joint is not None
            pairs = [(*pair, *to) for pair in combinations(self.names, 2) if to not in (pair[:1], pair[1:])]
            found = self._joint.relations([asked._replace(anchors=pair).message for pair in pairs]).settled().tolist()
            self._settled[alike] = dict(zip(pairs, found, strict=True))
        return {1: 1.0, -1: 0.0}.get(self._settled[alike][asked.anchors])

    def chance(self, number: int) -> float | None:
        """Return P(an uncertain relation holds); None if the belief gives no number for it."""
        return self._prob(self.uncertain[number])

    def _prob(self, asked: "_Asked") -> float | None:
        before = self._belief if asked.earlier and isinstance(self._belief, EarlierBeliefs) else None
        match asked.kind, asked.anchors, asked.meaning:
            case "on", (one, other), _:
                return before.prob_was_on(one, other) if before else self._belief.prob_on(one, other)
            case "near", (one, other), _:
                prob_near = before.prob_was_near if before else self._belief.prob_near
                return prob_near(one, other, asked.distance_m)
            case "weighs", (one,), WeightInterval() as meaning:
                return self._belief.prob_property(one, meaning)
        return None


class _Asked(NamedTuple):
    """A relation that may hold, as `messages.Relation`, of any names."""

    kind: RelationKind
    anchors: tuple[str, ...]
    distance_m: float
    meaning: WeightInterval | None
    earlier: bool

    @property
    def message(self) -> Relation:
        """The question to a belief."""
        return Relation(**self._asdict())


def poisson(mean: float, most: int) -> list[float]:
    """Return P(N = k) of a Poisson number N for k < `most`, and P(N >= most)."""
    terms = [exp(-mean)]
    for k in range(1, most):
        terms.append(terms[-1] * mean / k)
    if most == 0:
        return [1.0]
    term, rest, k = terms[-1] * mean / most, 0.0, most
    while term > 0.0 and rest + term != rest:  # summed from its own terms: 1 - the others would cancel
        rest, k = rest + term, k + 1
        term *= mean / k
    return [*terms, rest]


def _number(one: Individual) -> int:
    assert isinstance(one, int)
    return one
