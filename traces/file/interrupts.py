"""Hold back Ctrl-C and requests to end while a few statements must run to their end."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

HELD: Final = (  # the command line raises the last one again after a lost interrupt
    signal.SIGINT,
    signal.SIGTERM,
    signal.SIGHUP,
    signal.SIGALRM,
)


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Let the block run to its end, then deliver an interrupt that came meanwhile.

    Only signals that have a handler in Python are held: the others end the process directly. Python delivers signals
    to the main thread alone, so other threads hold nothing.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    handlers = {number: handler for number in HELD if callable(handler := signal.getsignal(number))}
    caught: list[int] = []
    try:
        for number in handlers:
            signal.signal(number, lambda caught_number, frame: caught.append(caught_number))
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        if caught:
            signal.raise_signal(signal.Signals(caught[0]))
