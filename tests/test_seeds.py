"""The table of many seeds."""

from pathlib import Path

import pytest

from skolem.tools.seeds import Task, report, run_all, run_one, seed_range, with_section

GREEN = Path(__file__).parent.parent / "scenarios" / "sim1_green.yaml"


def row(seed: int, believed: bool, true: bool | None, actions: int, seconds: float) -> dict[str, object]:
    parts = ("rendering_and_detection", "estimation", "reasoning", "motion_planning", "physics", "total")
    return {
        "seed": seed,
        "status": "goal_achieved" if believed else "error",
        "reason": "because",
        "believed": believed,
        "true": true,
        "anchor": "sodaC" if believed else None,
        "actions": actions,
        "replans": 2,
        "wall_s": dict.fromkeys(parts, seconds),
    }


@pytest.mark.parametrize(("text", "seeds"), [("0-2", [0, 1, 2]), ("7", [7]), ("3-3", [3])])
def test_seeds_are_a_range_with_both_ends(text: str, seeds: list[int]) -> None:
    assert list(seed_range(text)) == seeds


def test_the_table_has_a_line_per_seed_and_the_medians() -> None:
    table = report(
        "sim1", "pybullet", [row(0, True, True, 8, 1.0), row(1, True, False, 9, 2.0), row(2, False, None, 4, 9.0)]
    )
    assert "2 of 3 runs ended with the goal believed, 1 of these truly so." in table
    assert "| 1 | yes | no | sodaC | 9 | 2 | 2.00 | 2.00 | 2.00 | 2.00 | 2.00 | 2.00 |" in table
    assert "| **median** | | | | **8** | **2** | **2.00** |" in table
    assert "- seed 2: error: because" in table


def test_a_section_replaces_its_own_and_leaves_the_others() -> None:
    text = with_section(with_section("# Results\n\nIntro.\n", "a", "first\n"), "b", "other\n")
    again = with_section(text, "a", "second\n")
    assert again == text.replace("first", "second")
    assert again.startswith("# Results\n\nIntro.\n")


def test_a_run_that_crashes_is_a_row_of_the_table(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("skolem.sim.symbolic.SymbolicWorld.execute", lambda self, action: 1 / 0)
    found = run_one(Task(GREEN, 0, "symbolic", tmp_path / "a.mcap"))
    assert (found["status"], found["believed"], found["true"]) == ("error", False, None)


def test_two_processes_give_the_same_rows_as_one(tmp_path: Path) -> None:
    def hashes(jobs: int) -> list[object]:
        tasks = [Task(GREEN, seed, "symbolic", tmp_path / f"{jobs}-{seed}.mcap") for seed in (0, 1)]
        return [found["content_hash"] for found in run_all(tasks, jobs)]

    assert hashes(1) == hashes(2)
