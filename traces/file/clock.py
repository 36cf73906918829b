"""Simulated time: an integer number of ticks since the start, and the nanoseconds that a trace stores."""

from skolem.traces.messages import TICKS_PER_SECOND

NANOSECONDS = 1_000_000_000


def time_ns(tick: int) -> int:
    """Return the log time of a tick in nanoseconds, rounded down."""
    return tick * NANOSECONDS // TICKS_PER_SECOND


def tick_at(log_time_ns: int) -> int:
    """Return the tick of a log time: the exact inverse of `time_ns`."""
    return -(-log_time_ns * TICKS_PER_SECOND // NANOSECONDS)
