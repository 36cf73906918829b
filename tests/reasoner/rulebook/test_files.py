"""No file of the machine is opened by a rule file from others, however it hides that it asks for one."""

import os
from itertools import product
from pathlib import Path

import pytest

from skolem.reasoner.rulebook import files
from skolem.reasoner.rulebook.files import RuleFile, parse

SECRET = "top secret"
FORMS = (
    '#include "{}".',
    '#include\t"{}".',
    '#include\n\n"{}".',
    '#include%* %* a *% *%"{}".',
    '#include % a comment\n"{}".',
    "#include <{}>.",
    'a.#include "{}".',
    'a#include "{}".',
    '#include"{}".',
)
BEFORE = (
    "",
    '"\n',
    'a("b\\\n").\n',
    'a("b\\"c").',
    'a("b\\\\").',
    'a("\\t").\n',
    "%* %* *% %* *% *%",
    "%*% *%",
    "% %*\n",
    "%\r\n",
    "'\n",
    "a'.\n",
    "%*\n*%",
    '% "\n',
    '%* " *%',
    "#program base.\n",
    "#script (lua) x #end.\n",
    "#script (python)\n#end.\n",
    "#theory t { &a/0 : x, any }.\n",
    "#const a = b.\n",
    "a :- &t { b }.\n",
    "\x0b",
    "\x0c",
)


def refused(content: bytes, folder: Path) -> str:
    """Return what is said of a rule file that is refused."""
    path = folder / "own.lp"
    path.write_bytes(content)
    statements, faults = parse(RuleFile("own", "own.lp", str(path), content, own=True))
    assert not any("secret" in str(statement) for statement in statements)
    assert faults
    return "\n".join(map(str, faults))


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    path = tmp_path / "secret.txt"
    path.write_text(SECRET, encoding="utf-8")
    return path


@pytest.mark.parametrize("sees", [True, False], ids=["scanned", "only the system judges"])
@pytest.mark.parametrize("before", BEFORE)
def test_no_include_is_followed_however_it_is_hidden(
    tmp_path: Path, secret: Path, before: str, sees: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not sees:
        monkeypatch.setattr(files, "_refused_tokens", lambda _: iter(()))
    for form, name in product(FORMS, (str(secret), "secret.txt")):
        said = refused((before + form.format(name)).encode(), tmp_path)
        assert "top secret" not in said.replace(f'"{SECRET}"', "")


@pytest.mark.parametrize("sees", [True, False], ids=["scanned", "only the system judges"])
def test_an_include_of_a_pipe_does_not_wait_for_it(tmp_path: Path, sees: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if not sees:
        monkeypatch.setattr(files, "_refused_tokens", lambda _: iter(()))
    os.mkfifo(tmp_path / "pipe")
    assert "#include is not allowed" in refused(f'"\n#include "{tmp_path}/pipe".\n"'.encode(), tmp_path)


@pytest.mark.parametrize(
    "text",
    [
        '% #include "secret.txt".',
        '%* #include "secret.txt". *%',
        '%* %* *% #include "secret.txt". *%',
        '%%* #include "secret.txt".',
    ],
)
def test_a_comment_may_say_include(tmp_path: Path, text: str) -> None:
    path = tmp_path / "own.lp"
    path.write_text(text, encoding="utf-8")
    statements, faults = parse(RuleFile("own", "own.lp", str(path), text.encode(), own=True))
    assert ([str(statement) for statement in statements], faults) == (["#program base."], [])


@pytest.mark.parametrize("encoding", ["utf-16", "utf-7", "utf-8-sig", "utf-32", "cp037"])
def test_other_encodings_hide_nothing(tmp_path: Path, secret: Path, encoding: str) -> None:
    content = f'#include "{secret}".'.encode(encoding)
    assert SECRET not in refused(content, tmp_path)


def test_files_can_be_opened_again_after_one_was_parsed(tmp_path: Path) -> None:
    refused(b'#include "x".', tmp_path)
    assert (tmp_path / "own.lp").read_bytes()
