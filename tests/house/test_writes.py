"""Files are written in one place, which follows no link; each other place that writes is listed with its reason."""

import ast
import re

import pytest
from kit.places import ROOT

ALLOWED = {  # file and function -> why it may write by itself
    ("traces/written.py", "created"): "the place",
    ("traces/written.py", "give_name"): "the place",
    ("traces/written.py", "put"): "the place",
    ("traces/written.py", "locked"): "the place",
    ("traces/written.py", "refuse_unwritable"): "the place",
    ("sim/robot/assets.py", "patched_urdf_path"): "a folder of its own in the user's cache",
    ("sim/robot/assets.py", "_write_model"): "the same",
    ("tools/recorded/rules.py", "_read"): "a temporary folder of its own, because clingo reads files",
    ("tools/sweep/task.py", "_setup"): "a temporary folder of its own",
    ("tools/view/viewer.py", "viewer"): "a temporary folder of its own",
    ("tools/view/viewer.py", "private_environment"): "the same",
    ("tools/view/viewer.py", "shoot"): "into memory",
    ("tools/words/terminal.py", "_lasting"): "standard output, which is open already",
}
MODE = re.compile(r"[rwxabt+]*[wxa+][rwxabt+]*")
NAMES = {  # of functions that write, move or link
    *("write_text", "write_bytes", "touch", "rename", "renames", "symlink_to", "hardlink_to", "symlink", "link"),
    *("save", "tofile", "savetxt", "savez", "copy2", "copyfile", "copyfileobj", "copytree", "move", "mkstemp"),
    *("NamedTemporaryFile", "FileIO", "Lasting"),
}


def writes(node: ast.AST) -> bool:
    """Return whether a node is a call that writes a file, or gives one its name."""
    if not isinstance(node, ast.Call):
        return False
    name = getattr(node.func, "attr", getattr(node.func, "id", ""))
    text = [str(n.value) for n in ast.walk(node) if isinstance(n, ast.Constant)]
    if name in ("open", "fdopen"):
        flags = {getattr(n, "attr", "") for n in ast.walk(node)}
        device = "devnull" in flags
        return not device and (bool(flags & {"O_WRONLY", "O_RDWR", "O_CREAT"}) or any(MODE.fullmatch(t) for t in text))
    if name == "replace":  # of a text it has two arguments, of a data class keywords; of a path one
        of_os = getattr(getattr(node.func, "value", None), "id", "") == "os"
        return of_os or (isinstance(node.func, ast.Attribute) and len(node.args) == 1 and not node.keywords)
    return name in NAMES


def writers(text: str) -> set[str]:
    """Return the names of the functions in a program that write by themselves."""
    functions = [n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.FunctionDef)]
    return {function.name for function in functions if any(map(writes, ast.walk(function)))}


def test_files_are_written_only_in_the_places_that_are_listed() -> None:
    found = set()
    for folder in ("traces", "reasoner", "estimation", "sim", "tools", "package"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            found |= {(name, function) for function in writers(path.read_text(encoding="utf-8"))}
    assert found == ALLOWED.keys()


@pytest.mark.parametrize(
    "line",
    [
        "path.write_text('a')",
        "open(path, 'w')",
        "path.open('ab')",
        "os.open(path, os.O_CREAT | os.O_WRONLY)",
        "draft.replace(path)",
        "os.replace(draft, path)",
        "draft.rename(path)",
        "image.save(path)",
        "shutil.copyfile(a, b)",
    ],
)
def test_a_planted_write_is_found(line: str) -> None:
    assert writers(f"def f():\n    {line}") == {"f"}


@pytest.mark.parametrize(
    "line",
    ["path.open('rb')", "text.replace('a', 'b')", "replace(fault, message='a')", "os.open(os.devnull, os.O_RDWR)"],
)
def test_what_only_reads_is_not_taken_for_a_write(line: str) -> None:
    assert writers(f"def f():\n    {line}") == set()
