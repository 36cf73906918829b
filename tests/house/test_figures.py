"""The figures of the house, on a checkout made for the purpose."""

from pathlib import Path

from house.figures import figures, table

PROJECT = '[tool.setuptools.package-dir]\n"skolem.sim" = "sim"\n'


def checkout(root: Path, files: dict[str, str]) -> Path:
    for name, text in {"pyproject.toml": PROJECT, "sim/__init__.py": "", **files}.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    return root


def test_rooms_and_files_side_by_side_are_counted_with_their_arrows_and_circles(tmp_path: Path) -> None:
    root = checkout(
        tmp_path,
        {
            "sim/room/__init__.py": "",
            "sim/room/a.py": "from skolem.sim import b\n",
            "sim/b.py": "from skolem.sim.c import c\n",
            "sim/c.py": "def c():\n    from skolem.sim.b import d\n",
        },
    )
    found = dict(figures(root))
    assert found["sim: rooms, arrows, circles"] == "3, 3, 1"
    assert found["circles of files in the whole product"] == "1"
    assert found["longest list a reader meets in one folder"] == "4 (sim)"
    assert found["lines of the product, Python"] == "4"


def test_files_over_the_limit_and_tests_by_directory_are_counted(tmp_path: Path) -> None:
    long = {"sim/long.py": "\n" * 401, "sim/short.py": "\n" * 400}
    tests = {f"tests/{name}.py": "\n" for name in ("test_a", "sim/test_b", "sim/test_c", "kit/double")}
    found = dict(figures(checkout(tmp_path, long | tests)))
    assert found["files over 400 lines"] == "1"
    assert found["test files, directories with test files"] == "3, 2"
    assert found["most test files in one directory"] == "2 (tests/sim)"
    assert found["lines of tests"] == "4"


def test_a_belief_of_ones_own_is_imported_from_where_it_is_defined_or_from_a_face(tmp_path: Path) -> None:
    mind = "class Agent:\n    pass\n\n\nclass Limits:\n    pass\n"
    root = checkout(tmp_path, {"sim/mind.py": f"\n{mind}", "sim/text.py": "\ndef parse_goal(text):\n    pass\n"})
    assert dict(figures(root))["imports for a belief of one's own"] == "2: skolem.sim.mind, skolem.sim.text"
    (root / "sim" / "__init__.pyi").write_text("from .mind import Agent as Agent, Limits as Limits\n", encoding="utf-8")
    assert dict(figures(root))["imports for a belief of one's own"] == "2: skolem.sim, skolem.sim.text"


def test_the_table_has_a_column_for_each_checkout(tmp_path: Path) -> None:
    roots = [checkout(tmp_path / name, {}) for name in ("before", "after")]
    header, rule, *rows = table(roots).splitlines()
    assert header == "|  | before | after |"
    assert all(line.count("|") == 4 for line in (rule, *rows))
