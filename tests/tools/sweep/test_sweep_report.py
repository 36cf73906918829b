"""What a sweep says of its runs: shares with intervals, calibration, effort, failures; and what is said meanwhile."""

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from skolem.reasoner.language.parser import parse_goal
from skolem.tools.sweep.progress import Bar, Lines, said_of
from skolem.tools.sweep.report import Part, line, promised, section, sections, with_section
from skolem.tools.sweep.rows import TIMES, Row
from skolem.tools.sweep.shares import wilson

GOAL = parse_goal("exists o. B(Den(lambda x. Green(x), o), 0.95) & B(In(o, table1), 0.9)", {"Green": 1, "In": 2})

NEAREST = "best candidate sodaC, p = 0.950 (green 0.97, exists 0.99); seen of the regions: _reg1_ 0.92"


def row(
    seed: int, status: str = "goal_achieved", true: bool | None = True, ops: str = "abc", total: float = 2.0
) -> Row:
    return Row(
        scenario="sim1",
        seed=seed,
        world="symbolic",
        status=status,  # type: ignore[arg-type]
        believed=status == "goal_achieved",
        true=true,
        own=true,
        expected="goal_achieved",
        actions=len(ops),
        replans=1,
        clingo_calls=10,
        simulated_s=4.0,
        goal_probability=0.95,
        anchor="sodaC",
        conjuncts=("green 0.97", "exists 0.99"),
        regions=("_reg1_ 0.92",),
        witness="sodaC" if true else None,
        displaced=(),
        sequence=tuple(ops),
        reason="because\nof it",
        trace=f"sim1-{seed}.mcap",
        content_hash="0",
        size_bytes=50_000,
        seconds=dict.fromkeys(TIMES, 0.25) | {"total": total},
    )


def part(*rows: Row) -> Part:
    return Part("sim1", "scenarios/sim1.yaml", "symbolic", (), {each.seed: GOAL for each in rows} or {0: GOAL}, rows)


@pytest.mark.parametrize(
    ("hits", "of", "low", "high"),
    [  # Newcombe, Statistics in Medicine 17 (1998), table I, method 3
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_intervals_are_those_of_the_literature(hits: int, of: int, low: float, high: float) -> None:
    assert wilson(hits, of) == pytest.approx((low, high), abs=5e-5)


def test_of_nothing_nothing_is_known() -> None:
    assert wilson(0, 0) == (0.0, 1.0)


def test_a_goal_promises_its_least_probability() -> None:
    assert promised(GOAL) == 0.9


def test_what_is_believed_and_what_is_true_are_counted_apart() -> None:
    text = section(part(row(0), row(1, true=False), row(2, "goal_unachievable", true=True), row(3, "error", None)))
    assert "| goal believed achieved | 2 of 4 | 50.0% |" in text
    assert "| believed and true | 1 of 4 | 25.0% |" in text
    assert "| true but not believed | 1 of 4 | 25.0% |" in text
    assert "| true among the believed (promised: 90%) | 1 of 2 | 50.0% |" in text


def test_every_failure_has_one_line_with_its_reason_and_trace() -> None:
    text = section(part(row(0), row(1, true=False), row(2, "limit_reached", False)))
    assert text.splitlines()[-4:-2] == [
        f"- seed 1: believed, but not true; {NEAREST}; sim1-1.mcap",
        f"- seed 2: limit_reached: because of it; {NEAREST}; sim1-2.mcap",
    ]


def test_runs_that_end_as_the_scenario_expects_are_counted() -> None:
    text = section(
        part(*(replace(each, expected="goal_unachievable") for each in (row(0, "goal_unachievable", False), row(1))))
    )
    assert "| ended as expected: goal_unachievable | 1 of 2 | 50.0% |" in text


def test_an_account_names_the_command_that_makes_it_again() -> None:
    (last,) = section(replace(part(row(3), row(4)), overrides=("noise=none",))).splitlines()[-1:]
    assert "`skolem sweep scenarios/sim1.yaml --seeds 3-4 --world symbolic --set noise=none -o DIR`" in last


def test_many_failures_that_say_the_same_are_one_line() -> None:
    alike = [row(seed, "goal_unachievable", False) for seed in (*range(10), 12, 14, 15)]
    text = section(part(*alike, row(11, true=False)))
    assert text.splitlines()[-4:-2] == [
        "- seeds 0-9, 12, 14-15: goal_unachievable: because of it",
        f"- seed 11: believed, but not true; {NEAREST}; sim1-11.mcap",
    ]


def test_effort_is_that_of_the_runs_that_ended_by_themselves() -> None:
    text = section(part(row(0, ops="abc"), row(1, ops="abcd"), row(2, ops="abcdefg"), row(3, "error", None, ops="")))
    assert "| actions | 4 | 3 | 7 |" in text
    assert "Simulated over wall time: median 2." in text
    assert "| - motion planning | 0.25 | 0.25 | 0.25 |" in text
    assert "| recording, % of the wall time | 12.50 | 12.50 | 12.50 |" in text
    assert "| trace, kB per simulated minute | 750 | 750 | 750 |" in text


def test_different_ways_to_success_are_counted_once_each() -> None:
    rows = [row(0, ops="ab"), row(1, ops="ba"), row(2, ops="ba"), row(3, ops="xyz", true=False)]
    assert "Distinct successful action sequences: 2. The most frequent (2 of 3): b, a." in section(part(*rows))


def test_a_scenario_of_which_no_run_is_done_has_an_account_too() -> None:
    assert "| goal believed achieved | 0 of 0 | - |" in section(part())
    assert line(part()) == "sim1, symbolic world: 0 of 0 believed, 0 of these true; nothing done"


def test_several_scenarios_have_an_overview_before_them() -> None:
    one, other = part(row(0), row(1, true=False)), replace(part(row(0, "goal_unachievable"), row(1, "error")), name="z")
    (key, text), *rest = sections([one, other])
    assert (key, [found for found, _ in rest]) == ("overview symbolic", ["sim1 symbolic", "z symbolic"])
    assert text.splitlines()[-2:] == [
        "| sim1 | 2 | 2 | 1 of 2 | 2 | 1 | 0 | 3 | 2 | 2 |",
        "| z | 2 | 0 | 0 of 2 | 0 | 0 | 0 | 3 | 2 | 2 |",
    ]
    assert [found for found, _ in sections([one])] == ["sim1 symbolic"]


def test_a_section_replaces_its_own_and_leaves_the_others() -> None:
    text = with_section(with_section("# Results\n\nIntro.\n", "a", "first\n"), "b", "other\n")
    again = with_section(text, "a", "second\n")
    assert again == text.replace("first", "second")
    assert again.startswith("# Results\n\nIntro.\n")


def test_lines_count_what_was_done_before(capsys: pytest.CaptureFixture[str]) -> None:
    lines = Lines(5, 3)
    lines.done(row(7))
    assert capsys.readouterr().err.splitlines() == [
        "3 of 5 runs are done already",
        "[4/5] sim1 seed 7: goal_achieved, true, 3 actions, 2.0 s",
    ]


def test_the_bar_shows_failures_above_it() -> None:
    drawn = StringIO()
    with Bar(2, 0, Console(file=drawn, force_terminal=True, width=120)) as bar:
        bar.done(row(0))
        bar.done(row(1, "limit_reached", False))
    assert said_of(row(1, "limit_reached", False)) in drawn.getvalue()
    assert "1 believed, 1 of them true" in drawn.getvalue()


# ---------------------------------------------------------------- whose goal it is, and worlds with answers


def test_a_goal_that_is_true_of_another_object_is_counted_apart() -> None:
    other = replace(row(1), own=False, witness="sodaB")
    text = section(part(row(0), other))
    assert "| believed and true | 1 of 2 | 50.0% |" in text
    assert "| believed, but true of another object alone | 1 of 2 | 50.0% |" in text
    assert "- seed 1: believed of sodaC, but true of sodaB alone;" in text


def test_to_give_up_is_a_failure_unless_the_answer_is_that_nothing_can_be_done() -> None:
    gave_up, found_out = row(1, "goal_unachievable", False), row(2, "goal_unachievable", False)
    other_goal = parse_goal("exists o. B(Den(lambda x. Green(x), o), 0.8)", {"Green": 1})
    rows = [row(0), gave_up, replace(found_out, expected="goal_unachievable"), row(3, "limit_reached", False)]
    worlds = replace(part(*rows), goals={0: GOAL, 1: other_goal}, source="--family three")
    text = section(worlds)
    assert "| achieved, of the achievable | 1 of 3 | 33.3% |" in text
    assert "| found impossible, of the impossible | 1 of 1 | 100.0% |" in text
    assert "| achievable, but given up as impossible | 1 of 3 | 33.3% |" in text
    assert "| achievable, but ended at a limit | 1 of 3 | 33.3% |" in text
    assert [seed in text for seed in ("- seed 1:", "- seed 2:", "- seed 3:")] == [True, False, True]
    assert line(worlds).startswith(
        "sim1, symbolic world: 1 of 3 achieved that can be; 1 of 4 believed, 1 of these true;"
    )
