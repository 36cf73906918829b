"""A child process for rule files from others: what clingo does with them is bounded in time and memory.

A rule file is a program. Three lines of one can keep clingo busy for ever, fill the memory of the machine, or end the
process that reads them, and clingo cannot be stopped from within. So a child, forked once for each set of rules, reads
them and answers every question that is put to them later; the system ends it at its limits. The limits are far beyond
what sound rules need, and end the command: no decision, offer or verdict depends on them.
"""

import contextlib
import faulthandler
import os
import pickle
import resource
import signal
import sys
import weakref
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from multiprocessing.connection import Connection, Pipe
from typing import Any, Final, NoReturn, TypeVar, cast

from skolem.reasoner.lint.wrong_rules import refuse_wrong
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.rulebook.files import RuleFile
from skolem.tools.loop.children import end_with_parent
from skolem.traces.errors import Fault, InputError, InternalError, SkolemError

SECONDS: Final = 5  # of computing, for one reading or question: the rules that ship need less than .1
BYTES: Final = 512 << 20  # of memory, beyond what the process has already: the rules that ship need 30 << 20
_DEPTH: Final = 100  # calls within calls that the child has less than its parent, which reads the same files after it

T = TypeVar("T")
_SLOW = f"takes more than {SECONDS} s of computing"
_LARGE = f"takes more than {BYTES >> 20} MB of memory"
_DEEP = "has terms or rules that are nested too deeply"
_REMEDY = "bound what each rule derives: smaller intervals and pools, fewer combinations, an end to each recursion"


class Apart:
    """Rules in a child process. Satisfies `reasoner.rulebook.book.Elsewhere`.

    Attributes:
        answer: What reading the rules returned besides the rules.
    """

    def __init__(self, titles: Sequence[str], read: Callable[[], tuple[Rulebook | None, object]]) -> None:
        """Fork a child and let it read the rules.

        Args:
            titles: The names of the rule files to which a fault is attributed.
            read: Reads the rules; returns them for later questions, and any other result for now.

        Raises:
            InputError: With every fault in the rules, or because reading them passes a limit.
        """
        self._titles = titles
        self._pipe, theirs = Pipe()
        sys.stdout.flush()
        sys.stderr.flush()
        pid = os.fork()
        if pid == 0:
            self._pipe.close()
            _serve(theirs, read)
        theirs.close()
        self._end = weakref.finalize(self, _end, pid, os.getpid(), self._pipe)
        self._pid = pid
        self.answer = self._answer(None)

    def __call__(self, work: Callable[..., Any], queries: object, *arguments: object) -> Any:
        """Return what `work` returns of the rules, of queries that are answered here, and of some arguments.

        Raises:
            InputError: If it passes a limit.
        """
        try:
            self._pipe.send((work, arguments))
        except OSError:
            raise self._ended() from None
        return self._answer(queries)

    def _answer(self, queries: object) -> Any:
        """Answer the child's queries until it has answered us."""
        try:
            while True:
                kind, *said = self._pipe.recv()
                if kind == "query":
                    self._pipe.send(_queried(queries, *said))
                elif kind == "answer":
                    return said[0]
                else:
                    raise said[0] if kind == "raised" else self._refused(said[0])
        except (EOFError, ConnectionError):
            raise self._ended() from None
        except BaseException as error:
            if not isinstance(error, SkolemError):
                self._end()  # interrupted: who knows what the child would say next
            raise

    def _ended(self) -> InputError:
        """Return the fault of rules that ended the child."""
        status = self._end() if self._end.alive else 0
        number = os.WTERMSIG(status) if status and os.WIFSIGNALED(status) else 0
        if number == signal.SIGPROF:
            return self._refused(_SLOW)
        if number in (signal.SIGKILL, signal.SIGABRT):
            return self._refused(_LARGE)
        return self._refused(_DEEP)

    def _refused(self, why: str) -> InputError:
        about = "this file" if len(self._titles) == 1 else "this file, or another that is read with it,"
        return InputError(Fault(title, 0, 0, f"{about} {why}; {_REMEDY}") for title in self._titles)


def rulebook_of(sources: Sequence[RuleFile], steps: bool = True) -> Rulebook:
    """Return the rules in files: those that ship in this process, all others in a child.

    Args:
        sources: The files, in the order in which they are to be loaded.
        steps: Whether rules that would stop a run are refused too.

    Raises:
        InputError: With every fault in every file, or because reading them passes a limit.
    """
    if all(file.ships for file in sources):
        return Rulebook.of(Queries, sources)

    def read() -> tuple[Rulebook, None]:
        found = Rulebook.of(Queries, sources)
        if steps:
            refuse_wrong(found)
        return found, None

    apart = Apart(_blamed(sources), read)
    return Rulebook.of(Queries, [replace(file, parsed=True) for file in sources], apart)


def bounded(sources: Sequence[RuleFile], work: Callable[[], T]) -> T:
    """Return what some work on rule files gives, done in a child unless all of them ship.

    Raises:
        InputError: If it passes a limit, or as the work itself does.
    """
    if all(file.ships for file in sources):
        return work()
    return cast("T", Apart(_blamed(sources), lambda: (None, work())).answer)


def _blamed(sources: Sequence[RuleFile]) -> list[str]:
    return [file.title for file in sources if not file.ships]


def _end(pid: int, parent: int, pipe: Connection) -> int:
    """End the child and return its status, if this is the process that has it."""
    pipe.close()
    if os.getpid() != parent:
        return 0
    with contextlib.suppress(ProcessLookupError, ChildProcessError):
        ended, status = os.waitpid(pid, os.WNOHANG)
        if not ended:
            os.kill(pid, signal.SIGKILL)
            _, status = os.waitpid(pid, 0)
        return status
    return 0


def _queried(queries: object, name: str, arguments: Sequence[object]) -> tuple[object, Exception | None]:
    try:
        return getattr(queries, name)(*arguments), None
    except Exception as error:  # it is the child's question: clingo has to come back from it
        return None, error


# ---------------------------------------------------------------- in the child


def _serve(pipe: Connection, read: Callable[[], tuple[Rulebook | None, object]]) -> NoReturn:
    """Read the rules and answer questions about them until nobody asks any more."""
    kept: list[Rulebook | None] = []

    def begin() -> object:
        rules, result = read()
        kept.append(rules)
        return result

    try:
        _confine()
        _reply(pipe, begin)
        while True:
            work, arguments = pipe.recv()
            _reply(pipe, partial(work, kept[0], _Remote(pipe), *arguments))
    finally:
        os._exit(0)


def _confine() -> None:
    """Take away what a child needs for nothing else than to do harm."""
    end_with_parent()
    faulthandler.disable()
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # Ctrl-C is for the parent
    for number in (signal.SIGTERM, signal.SIGPROF):
        signal.signal(number, signal.SIG_DFL)
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):  # the last words of libraries are no message
        os.dup2(nothing, stream)
    with open("/proc/self/statm", encoding="ascii") as sizes:
        own = int(sizes.read().split()[0]) * resource.getpagesize()
    _limit(resource.RLIMIT_AS, own + BYTES)
    _limit(resource.RLIMIT_CORE, 0)
    sys.setrecursionlimit(sys.getrecursionlimit() - _DEPTH)


def _limit(what: int, most: int) -> None:
    _, hard = resource.getrlimit(what)
    resource.setrlimit(what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def _reply(pipe: Connection, work: Callable[[], object]) -> None:
    """Do some work within the limits and send what comes of it."""
    signal.setitimer(signal.ITIMER_PROF, SECONDS)  # of computing by this process; RLIMIT_CPU counts whole seconds alone
    try:
        said = pickle.dumps(("answer", work()))
    except SkolemError as error:
        said = pickle.dumps(("raised", error))
    except MemoryError:
        said = pickle.dumps(("spent", _LARGE))
    except RecursionError:
        said = pickle.dumps(("spent", _DEEP))
    except Exception as error:
        said = pickle.dumps(("raised", InternalError(f"{type(error).__name__}: {error}")))
    pipe.send_bytes(said)


class _Remote:
    """Passes the queries of rules on to the parent process."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe

    def __getattr__(self, name: str) -> Callable[..., Any]:
        def ask(*arguments: object) -> Any:
            self._pipe.send(("query", name, arguments))
            found, error = self._pipe.recv()
            if error is not None:
                raise error
            return found

        return ask
