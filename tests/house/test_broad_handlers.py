"""Broad handlers hide faults: each place that has one is listed here, with its reason."""

import ast

from kit.places import ROOT

ALLOWED = {  # file and function -> why every exception is caught there
    ("reasoner/rulebook/asking.py", "_answer"): "a callback given to clingo: it has to come back from it",
    ("tools/cli.py", "_run"): "the last handler of the program",
    ("tools/explain/explaining.py", "explained"): "a decision that failed is taken again, and may fail again",
    ("tools/loop/apart.py", "_answer"): "ends the child process, and raises again",
    ("tools/loop/apart.py", "_queried"): "a callback given to clingo, in the child process",
    ("tools/loop/apart.py", "_reply"): "the child process sends its fault to the parent, which raises it",
    ("tools/loop/worlds.py", "_loaded"): "the import of a package of others: a mistake of the input",
    ("tools/recorded/replaying.py", "_go_on"): "a step that failed is taken again, and may fail again",
    ("tools/recorded/rethinking.py", "decide"): "a decision that failed is taken again, and may fail again",
    ("tools/replay/replayer.py", "report_even_of_faults"): "one replay of many",
    ("tools/replay/reproducing.py", "reproduce"): "a run that failed is done again, and may fail again",
    ("tools/run/running.py", "execute"): "one run: its end is told, and then the fault",
    ("tools/sweep/task.py", "perform"): "one run of many: its trace has the reason",
    ("tools/view/viewer.py", "_until"): "libraries that speak to a viewer which does not listen yet",
    ("traces/file/writer.py", "__enter__"): "removes the file that was begun, and raises again",
}
BROAD = ("Exception", "BaseException")


def broad(node: ast.AST) -> bool:
    """Return whether a node catches every exception."""
    if isinstance(node, ast.ExceptHandler):
        return node.type is None or any(isinstance(n, ast.Name) and n.id in BROAD for n in ast.walk(node.type))
    if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == "suppress":
        return any(isinstance(argument, ast.Name) and argument.id in BROAD for argument in node.args)
    return False


def test_every_exception_is_caught_only_in_the_places_that_are_listed() -> None:
    found = set()
    for folder in ("traces", "reasoner", "estimation", "sim", "tools", "package"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            functions = [
                n for n in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(n, ast.FunctionDef)
            ]
            name = path.relative_to(ROOT).as_posix()
            found |= {(name, function.name) for function in functions if any(map(broad, ast.walk(function)))}
    assert found == ALLOWED.keys()
