"""A belief that is a table of relations, for the meaning of descriptions."""

from collections.abc import Mapping, Sequence

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.traces.messages import Meaning

BOOK = Rulebook.load(Queries)
WORDS = BOOK.vocabulary.words()
ROUNDING = 1e-12  # absolute; a hundred operations of 1e-16 each, and a reserve


class Table:
    """A belief as a table of `P(word(anchor))`, `P(on(anchor, support))` and `P(exists)`; missing relations have 0."""

    def __init__(
        self,
        anchors: Sequence[str],
        relations: Mapping[tuple[str, ...], float],
        exists: Mapping[str, float] | None = None,
        version: int = 0,
    ) -> None:
        self._anchors, self._relations, self._exists = tuple(anchors), dict(relations), dict(exists or {})
        self._version = version
        self.asked = 0

    @property
    def version(self) -> int:
        return self._version

    def anchors(self) -> tuple[str, ...]:
        return self._anchors

    def prob_exists(self, anchor: str) -> float:
        return self._exists.get(anchor, 1.0)

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        self.asked += 1
        word = next(word for word, known in BOOK.vocabulary.meanings.items() if known == meaning)
        return self._relations.get((word, anchor), 0.0)

    def prob_on(self, anchor: str, support: str) -> float:
        self.asked += 1
        return self._relations.get(("on", anchor, support), 0.0)

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        self.asked += 1
        return self._relations.get(("near", anchor, other), 0.0) if distance_m > 0 else 0.0
