"""A plugin of pytest that checks mutants by tests, in one process that forks for each mutant.

The product and the tests are imported once. Then a fork runs all tests with coverage, which gives the cost and the
lines of each. Every mutant gets a fork, which replaces the code of the changed function and runs the tests of its line,
those of the cheapest files first, until one fails.
"""

import gc
import math
import os
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import Connection
from types import CodeType, FunctionType
from typing import Literal, TypeVar

import coverage
import pytest

from benchmarks.mutants.drawing import ROOT, Mutant

T = TypeVar("T")
Outcome = Literal["killed", "timeout", "crashed", "survived", "uncovered"]
LEAST_S, TIMES = 2.0, 4.0  # CPU time that a test may take, beside so many times what it takes without a mutant
WAIT_S, WAITS = 300.0, 100.0  # time on the clock after which a mutant counts as waiting for ever; machines may be busy
MEMORY = 8 << 30  # bytes of address space


@dataclass(frozen=True, slots=True)
class Result:
    """The result of a mutant.

    Attributes:
        mutant: The mutant.
        outcome: `killed` by a failing test, by a `timeout` or by the end of the process (`crashed`); or `survived`, or
            no test runs its line (`uncovered`).
        tests: Number of tests that run its line.
        by: The test that failed.
    """

    mutant: Mutant
    outcome: Outcome
    tests: int
    by: str = ""


@dataclass(slots=True)
class _Measured:
    """The cost and the lines of the tests without a mutant.

    Attributes:
        seconds: CPU time of each test.
        failed: Numbers of the tests that fail.
        ran: Numbers of the tests that run a line, by path and line.
    """

    seconds: list[float] = field(default_factory=list)
    failed: list[int] = field(default_factory=list)
    ran: dict[tuple[str, int], set[int]] = field(default_factory=dict)


class Checker:
    """Checks mutants instead of running the tests that pytest has collected."""

    def __init__(self, mutants: Sequence[Mutant], tell: Callable[[Result], None]) -> None:
        """Check these mutants; `tell` gets each result when it is known."""
        self._mutants, self._tell = mutants, tell
        self._failed = False
        self.broken: list[str] = []  # tests that fail without a mutant: nothing was checked

    @pytest.hookimpl(trylast=True)
    def pytest_configure(self) -> None:
        """Let property tests stop at any failing example: a search for the smallest takes minutes."""
        from hypothesis import Phase, settings  # pytest must import it first

        quick = settings(settings(), phases=(Phase.explicit, Phase.generate))
        settings.register_profile("mutants", quick)
        settings.load_profile("mutants")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a failing test."""
        self._failed |= report.failed

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Measure the tests, then check each mutant."""
        for path in sorted({mutant.path for mutant in self._mutants}):
            import_module(module_of(path))
        measured = in_fork(lambda: self._measure(session))
        assert isinstance(measured, _Measured), f"the tests end the process: {measured}"
        self.broken = [session.items[number].nodeid for number in measured.failed]
        if not self.broken:
            for mutant in self._mutants:
                self._tell(self._check(mutant, session, measured))
        return True

    def _measure(self, session: pytest.Session) -> _Measured:
        paths = sorted({mutant.path for mutant in self._mutants})
        traced = coverage.Coverage(data_file=None, include=[str(ROOT / path) for path in paths], config_file=False)
        found = _Measured()
        traced.start()
        for number, failed in self._run(session, range(len(session.items)), traced.switch_context, found.seconds):
            if failed:
                found.failed.append(number)
        traced.stop()
        data = traced.get_data()
        for path in paths:
            for line, contexts in data.contexts_by_lineno(str(ROOT / path)).items():
                found.ran[path, line] = {int(context) for context in contexts if context}
        return found

    def _run(
        self,
        session: pytest.Session,
        numbers: Sequence[int],
        begin: Callable[[str], object] = lambda _: None,
        seconds: list[float] | None = None,
    ) -> Iterator[tuple[int, bool]]:
        """Run tests in the given order, and yield for each its number and whether it failed."""
        reporter = session.config.pluginmanager.get_plugin("terminalreporter")
        if reporter is not None:
            session.config.pluginmanager.unregister(reporter)
        for place, number in enumerate(numbers):
            following = session.items[numbers[place + 1]] if place + 1 < len(numbers) else None
            begin(str(number))
            before, self._failed = time.process_time(), False
            session.config.hook.pytest_runtest_protocol(item=session.items[number], nextitem=following)
            if seconds is not None:
                seconds.append(time.process_time() - before)
            yield number, self._failed

    def _check(self, mutant: Mutant, session: pytest.Session, measured: _Measured) -> Result:
        first, last = mutant.lines
        covering = set().union(*(measured.ran.get((mutant.path, line), set()) for line in range(first, last + 1)))
        if not covering:
            return Result(mutant, "uncovered", 0)
        order = _cheapest_first(covering, measured.seconds, [item.path.name for item in session.items])

        def begin(number: str) -> None:
            allow(LEAST_S + TIMES * measured.seconds[int(number)])

        def until_one_fails() -> str:
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            put_in(mutant)
            ran = self._run(session, order, begin)
            return next((session.items[number].nodeid for number, failed in ran if failed), "")

        by = in_fork(until_one_fails, WAIT_S + WAITS * sum(measured.seconds[number] for number in covering))
        if isinstance(by, Ended):
            return Result(mutant, by.how, len(covering))
        return Result(mutant, "killed" if by else "survived", len(covering), by)


def _cheapest_first(numbers: Iterable[int], seconds: Sequence[float], files: Sequence[str]) -> list[int]:
    """Return the tests in the order of their run: tests of one file stay together, since they share fixtures."""
    chosen = sorted(numbers)
    total = {name: sum(seconds[number] for number in chosen if files[number] == name) for name in set(files)}
    return sorted(chosen, key=lambda number: (total[files[number]], files[number], seconds[number], number))


# ---------------------------------------------------------------- the change


def module_of(path: str) -> str:
    """Return the name under which a file of the product is imported."""
    return f"skolem.{path.removesuffix('.py').replace('/', '.')}".removesuffix(".__init__")


def put_in(mutant: Mutant) -> None:
    """Replace the code of every function that the mutant changes, so that all references to it run the mutant.

    Raises:
        LookupError: If no function was changed.
    """
    file = sys.modules[module_of(mutant.path)].__file__
    assert file is not None
    changed = {
        (code.co_qualname, code.co_firstlineno): code for code in _functions(compile(mutant.source, file, "exec"))
    }
    found = False
    for function in [thing for thing in gc.get_objects() if isinstance(thing, FunctionType)]:
        old = function.__code__
        new = changed.get((old.co_qualname, old.co_firstlineno)) if old.co_filename == file else None
        if new is not None and new != old:
            function.__code__ = new
            found = True
    if not found:
        raise LookupError(f"{mutant.path}:{mutant.line}: no function has the changed code")


def _functions(code: CodeType) -> Iterator[CodeType]:
    """Yield the code of all functions in a module, also of those in classes."""
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield inner
            yield from _functions(inner)


# ---------------------------------------------------------------- the fork


@dataclass(frozen=True, slots=True)
class Ended:
    """A fork that ended without an answer."""

    how: Literal["timeout", "crashed"]


def in_fork(work: Callable[[], T], wait_s: float | None = None) -> T | Ended:
    """Return what `work` returns in a fork of this process, which is ended after so many seconds on the clock."""
    context = get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(work, sender))
    process.start()
    sender.close()
    try:
        answer: T | Ended = receiver.recv() if receiver.poll(wait_s) else Ended("timeout")
    except EOFError:
        process.join()
        answer = Ended("timeout" if process.exitcode == -signal.SIGXCPU else "crashed")
    process.kill()
    process.join()
    return answer


def allow(seconds: float) -> None:
    """End this process once it has taken so much more CPU time, to a second."""
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time() + seconds), most))


def _answer(work: Callable[[], object], sender: Connection) -> None:
    sender.send(work())
    sender.close()
    os._exit(0)
