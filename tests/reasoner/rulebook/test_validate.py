"""Each mistake in a rule file is refused with its place: one file of `data/bad_rules` per mistake.

A bad file says in its first lines what is expected of it, as `% expect: line:column: message`.
"""

from pathlib import Path

import pytest
from kit.places import DATA

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.rulebook.files import MAX_BYTES, RuleFile, parse
from skolem.reasoner.rulebook.validate import query_arities
from skolem.traces.errors import InputError

BAD = sorted((DATA / "bad_rules").glob("*.lp"))


@pytest.mark.parametrize("path", BAD, ids=[path.stem for path in BAD])
def test_a_bad_rule_file_is_refused_with_every_fault_in_its_place(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    expected = [line.removeprefix("% expect: ") for line in lines if line.startswith("% expect: ")]
    with pytest.raises(InputError) as caught:
        Rulebook.load(Queries, [path])
    found = [f"{fault.line}:{fault.column}: {fault.message}" for fault in caught.value.faults]
    assert {fault.file for fault in caught.value.faults} == {str(path)}
    assert len(found) == len(expected)
    for actual, start in zip(found, expected, strict=True):
        assert actual.startswith(start)


def test_a_fault_shows_the_line_with_a_caret() -> None:
    path = next(path for path in BAD if path.stem == "undefined_predicate")
    with pytest.raises(InputError) as caught:
        Rulebook.load(Queries, [path])
    line, caret = str(caught.value).splitlines()[1:]
    assert line[caret.index("^") :].startswith("stpe(S)")


def test_faults_of_several_files_are_reported_together() -> None:
    chosen = [path for path in BAD if path.stem in ("choice", "external")]
    with pytest.raises(InputError) as caught:
        Rulebook.load(Queries, chosen)
    assert [fault.file for fault in caught.value.faults] == [str(path) for path in chosen]


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"p" * (MAX_BYTES + 1), "at most 200000 bytes are read"), (b"p(\xff).", "not UTF-8: byte 2")],
)
def test_a_file_that_is_no_text_of_reasonable_size_is_refused(content: bytes, message: str) -> None:
    statements, (fault,) = parse(RuleFile("own", "own.lp", "own.lp", content, own=True))
    assert not statements
    assert message in fault.message


def test_queries_are_the_public_methods_with_their_numbers_of_arguments() -> None:
    class Asked:
        def mass(self, anchor: str) -> int:
            return len(anchor)

        def between(self, low: int, high: int) -> int:
            return high - low

        def _private(self) -> None: ...

    assert query_arities(Asked) == {"mass": 1, "between": 2}
