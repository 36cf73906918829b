"""Replays of one trace after another, each with a report; rules that several traces share are read once."""

from pathlib import Path

from skolem.tools.recorded import fingerprint
from skolem.tools.recorded.divergences import comparison_fields, divergence_lines
from skolem.tools.recorded.replaying import Options, Replayed, replay
from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import RecordedRun
from skolem.tools.replay.reports import Report, Wanted
from skolem.traces.compare.diff import tolerance_for
from skolem.traces.errors import InputError, TraceError


class Replayer:
    """Replays traces as the command line asks."""

    def __init__(self, wanted: Wanted) -> None:
        """Prepare the replays.

        Raises:
            InputError: If the changed rules, goal or values are wrong for every trace.
        """
        self._wanted = wanted
        self._rulebooks = Rulebooks()
        self._what_if = None
        if wanted.is_what_if:
            from skolem.tools.replay.what_if_reports import WhatIf  # reads scenarios, which other replays do not need

            self._what_if = WhatIf(wanted.rules, wanted.overrides)

    def report(self, path: Path) -> Report:
        """Replay one trace and return its report.

        Raises:
            InputError: If its rules, or the changes, are not sound.
            TraceError: If the trace cannot be read.
        """
        run = RecordedRun(path)
        return self._replayed(run) if self._what_if is None else self._what_if.report(run)

    def report_even_of_faults(self, path: Path) -> Report:
        """Replay one trace of many and return its report; an error becomes a report, too."""
        try:
            return self.report(path)
        except InputError as error:
            return Report("bad_input", str(error).splitlines(), {"reason": str(error)})
        except TraceError as error:
            return Report("unsound", [str(error).removeprefix(f"{path}: ")], {"reason": str(error)})
        except Exception as error:  # an error of the product must not stop the other replays
            reason = f"{type(error).__name__}: {error}"
            return Report("internal", [f"internal error: {reason}; replay it alone to see where"], {"reason": reason})

    def _replayed(self, run: RecordedRun) -> Report:
        wanted = self._wanted
        other = fingerprint.differences(run.environment)
        tolerance = tolerance_for("other machine" if other else "equal machine").with_floats(wanted.atol, wanted.rtol)
        options = Options(tolerance, wanted.from_step, wanted.re_anchor, wanted.plan_motions, wanted.keep_all)
        replayed = replay(run, options, rulebooks=self._rulebooks)
        comparison = replayed.comparison
        lines = [_headline(replayed)]
        if other and (comparison.tolerated or not comparison.identical):
            lines.append(f"recorded on another machine ({', '.join(other)}): floats compared with tolerance")
        if replayed.believes_otherwise:
            acts = comparison.differing["/action"]
            so = f"{acts} actions differ" if acts else "the robot acts as recorded"
            lines.append(f"the estimator has changed: after the same observations it believes otherwise; {so}")
        lines += divergence_lines(comparison)
        if replayed.stopped:
            lines.append(f"stopped: {replayed.stopped}")
        return Report("identical" if replayed.identical else "diverged", lines, _fields(replayed, other))


def _headline(replayed: Replayed) -> str:
    word = "IDENTICAL" if replayed.identical else "DIVERGED"
    compared = replayed.comparison
    messages = f"{compared.compared.total()} messages" if replayed.identical else compared.in_words()
    end = "" if replayed.ended or replayed.stopped else ", the record has no end"
    error = f"; {replayed.other_end}" if replayed.other_end else ""
    return f"{word}: {replayed.decisions} decisions, {messages}{end}; {_speed(replayed)}{error}"


def _speed(replayed: Replayed) -> str:
    text = f"{replayed.simulated_s:.1f} s simulated in {replayed.seconds:.2f} s"
    if replayed.recorded_s is not None:
        text += f", {replayed.recorded_s / replayed.seconds:.0f} times as fast as the run"
    return text


def _fields(replayed: Replayed, other: list[str]) -> dict[str, object]:
    return {
        "decisions": replayed.decisions,
        "ended": replayed.ended,
        "estimator_changed": replayed.believes_otherwise,
        "other_end": replayed.other_end,
        "stopped": replayed.stopped,
        "simulated_s": round(replayed.simulated_s, 3),
        "replay_s": round(replayed.seconds, 3),
        "run_s": replayed.recorded_s,
        "machine_differs_in": other,
        **comparison_fields(replayed.comparison),
    }
