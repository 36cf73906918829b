"""The `skolem` command: the table of verbs, each of which is imported when it is used.

May import: explain, files, generate, replay, rules, run, show, sweep, view.
"""

import difflib
import gc
import os
import signal
import sys
from collections.abc import Sequence
from importlib import import_module
from types import FrameType
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from skolem.tools.words.internal import internal_lines
from skolem.tools.words.terminal import lasting_output, output

VERBS = {  # verb -> (module with an `app`, its first docstring line)
    "check": (
        "skolem.tools.files.check",
        "Check that traces are whole and unchanged; name the first fault of each, with its position and a remedy.",
    ),
    "diff": (
        "skolem.tools.files.diff",
        "Print the first difference of two runs, how often each field differs, and the first different decision.",
    ),
    "info": (
        "skolem.tools.show.info",
        "Print the inputs and the result of a run, and the size of each topic in its trace.",
    ),
    "recover": (
        "skolem.tools.files.recover",
        "Save every whole message of a trace that was cut off or damaged.",
    ),
    "replay": (
        "skolem.tools.replay.command",
        "Take the decisions of recorded runs again, without a simulator, and compare; or try other rules or goals.",
    ),
    "reproduce": (
        "skolem.tools.replay.reproduce",
        "Run a recorded run again from its attached scenario, rules and seed, and compare everything but wall times.",
    ),
    "explain": (
        "skolem.tools.explain.command",
        "Explain one decision of a run: why this object, why this action, why plans were dropped, why the run ended.",
    ),
    "generate": (
        "skolem.tools.generate.command",
        "Draw a random scenario of a family, with a known answer.",
    ),
    "rules": (
        "skolem.tools.rules.command",
        "Check rule files, or print the reference of rules, words and queries.",
    ),
    "run": ("skolem.tools.run.command", "Run a scenario and record it as a trace."),
    "scenario": ("skolem.tools.rules.scenario", "Check scenario files, or print their JSON Schema."),
    "show": (
        "skolem.tools.show.command",
        "Print the plans of a run: every plan, its refinements, the actions and the dropped plans.",
    ),
    "sweep": (
        "skolem.tools.sweep.command",
        "Run scenarios for many seeds, several at a time, and write the results as tables.",
    ),
    "trace": (
        "skolem.tools.files.trace",
        "Record golden traces again, which is the only way to change them.",
    ),
    "view": (
        "skolem.tools.view.command",
        "Show a run: robot, true and believed objects, camera, plans, decisions and curves, over steps or time.",
    ),
}
BAD_INPUT, BAD_TRACE, INTERNAL, INTERRUPTED, NOT_READ = 2, 3, 4, 130, 141
AGAIN_S = 0.01  # delay before a lost request to end is repeated
GARBAGE = 100_000  # new objects before a search for garbage: it visits all imported modules, and they stay anyway


class LazyGroup(TyperGroup):
    """A group of commands that loads only the module of the verb that is used.

    Some versions of typer contain click's classes, others import them from click: hence `Any`.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the verbs in the order of the table."""
        return list(VERBS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Import a verb's module and return its command."""
        if cmd_name not in VERBS:
            return None
        command = typer.main.get_command(import_module(VERBS[cmd_name][0]).app)
        command.name = cmd_name
        return command

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """List the verbs without importing any."""
        with formatter.section("Verbs"):
            formatter.write_dl([(name, line) for name, (_, line) in VERBS.items()])

    def shell_complete(self, ctx: Any, incomplete: str) -> Any:
        """Complete a verb without importing any, or an option of a verb."""
        if incomplete.startswith("-"):
            return super().shell_complete(ctx, incomplete)
        stand_ins = TyperGroup(commands={name: TyperCommand(name, help=line) for name, (_, line) in VERBS.items()})
        return stand_ins.shell_complete(type(ctx)(stand_ins), incomplete)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the verb; for an unknown one name the nearest verb."""
        if args[0] not in VERBS and not ctx.resilient_parsing:  # completion sets resilient_parsing
            close = difflib.get_close_matches(args[0], VERBS, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"there are: {', '.join(VERBS)}"
            ctx.fail(f"no verb '{args[0]}'; {hint}")
        return super().resolve_command(ctx, args)


app = typer.Typer(
    cls=LazyGroup,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        output(f"skolem {version('skolem')}")
        raise typer.Exit


@app.callback()
def skolem(
    _version: Annotated[
        bool, typer.Option("--version", help="Print the version.", is_eager=True, callback=_print_version)
    ] = False,
) -> None:
    """Achieve goals about objects that are only described.

    Exit status: 0 done, 1 goal not achieved, 2 bad input, 3 a trace cannot be read or is
    unsound, or a trace or the output cannot be written to its end, 4 internal error, 130 interrupted.
    """


def main() -> int:
    """Run the command line and return the exit status."""
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # plugins of other packages take time
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # more threads are slower on small matrices, and not repeatable
    gc.set_threshold(GARBAGE)
    asked: list[int] = []

    def ask(number: int, frame: FrameType | None) -> None:
        asked.append(number)
        signal.default_int_handler(number, frame)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM):  # so that the trace is closed; see _ask_again too
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, ask)
    _end_with_the_terminal()
    sys.unraisablehook = _ask_again
    written = lasting_output()
    status = _run(asked)
    sys.stdout.flush()
    if asked and status == INTERNAL:
        status = INTERRUPTED
    return status if written is None else _of_lost_output(written.lost, status)


def _of_lost_output(lost: OSError | None, status: int) -> int:
    """Return the exit status of a command whose output may have been lost; that is said, unless the reader left."""
    if lost is None:
        return status
    if isinstance(lost, BrokenPipeError):  # the reader, such as `head`, has seen enough
        return NOT_READ
    output(f"standard output cannot be written: {lost.strerror}", file=sys.stderr)
    return BAD_TRACE


def _end_with_the_terminal() -> None:
    """Take the end of the terminal as a request to end, unless the signal is ignored, as under nohup."""
    if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
        return
    terminals = [number for number in (1, 2) if os.isatty(number)]

    def hung_up(number: int, frame: FrameType | None) -> None:
        for gone in (terminal for terminal in terminals if not os.isatty(terminal)):
            os.dup2(os.open(os.devnull, os.O_WRONLY), gone)  # later output would fail
        signal.default_int_handler(number, frame)

    signal.signal(signal.SIGHUP, hung_up)


def _ask_again(lost: "sys.UnraisableHookArgs") -> None:
    """Repeat a lost request to end: Python drops exceptions that are raised while an object is destroyed."""
    if issubclass(lost.exc_type, KeyboardInterrupt):
        signal.setitimer(signal.ITIMER_REAL, AGAIN_S)
    else:
        sys.__unraisablehook__(lost)


def _run(asked: Sequence[int]) -> int:
    """Run the command and return its exit status; `asked` holds the requests to end."""
    try:
        app(prog_name="skolem")
    except SystemExit as leaving:
        return leaving.code if isinstance(leaving.code, int) else int(leaving.code is not None)
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        return INTERRUPTED if asked and not _meant(error) else _explain(error)  # libraries make another error of it
    return 0


def _meant(error: Exception) -> bool:
    from skolem.traces.errors import SkolemError

    return isinstance(error, SkolemError)


def _explain(error: Exception) -> int:
    """Print the error on standard error; return the exit status."""
    from skolem.traces.errors import InputError, TraceError

    if isinstance(error, InputError | TraceError):
        output(error, file=sys.stderr)
        return BAD_INPUT if isinstance(error, InputError) else BAD_TRACE
    output(f"internal error: {type(error).__name__}: {error}", file=sys.stderr)
    output("\n".join(internal_lines(error, None)), file=sys.stderr)
    return INTERNAL
