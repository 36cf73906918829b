"""The reference page is what the rule files say."""

from pathlib import Path

from kit.places import ROOT

from skolem.reasoner.lint.docs import reference, sections
from skolem.reasoner.lint.linting import CODES
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import RULE_FILES, Rulebook


def test_the_committed_page_is_the_one_that_the_rules_give() -> None:
    page = (ROOT / "docs" / "rules-reference.md").read_text(encoding="utf-8")
    assert reference(Rulebook.load(Queries)) == page, "skolem rules doc -o docs/rules-reference.md"


def test_every_rule_of_every_file_stands_on_the_page() -> None:
    book = Rulebook.load(Queries)
    text = reference(book)
    assert all(f"(`{name}.lp`)" in text for name in RULE_FILES)
    for heading in ("`pick(H,O)`: operator", "`examine(E,Props,O,P)`: inference rule", "`@believed(word, anchor)`"):
        assert heading in text
    assert "slip_cost` | 51293 | -ln .95: the object may slip; p = 0.95" in text
    assert not any(f"allow {code}" in text for code in CODES)


def test_an_own_file_adds_its_words_operators_and_comments(tmp_path: Path) -> None:
    own = tmp_path / "push.lp"
    own.write_text(
        "%# Push: shove a thing aside.\n%  By hand.\n%\n%  Input: goal/1\n\n% Never far.\n"
        "step(push(O)) :- goal(b(on(O, _), _)).\nexecutes(S, look(O)) :- step(S), S = push(O).\n"
        "% It slides.\nresult(S, b(on(O, T), P)) :- step(S), S = push(O), goal(b(on(O, T), P)).\n"
        "weight(full, 450, any).\n",
        encoding="utf-8",
    )
    book = Rulebook.load(Queries, [own])
    text = reference(book)
    assert "## Push: shove a thing aside (`push.lp`)\n\nBy hand.\n" in text
    assert "### `push(O)`: operator" in text
    assert "| `b(on(O,T),P)` | `goal(b(on(O,T),P))` | It slides. |" in text
    assert "| full | weight: at least 450 g |" in text
    words = sections(book)["words"]
    assert isinstance(words, list)
    assert {"word": "full", "means": "weight: at least 450 g"} in words
