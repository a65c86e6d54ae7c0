"""Early ends of a command, by Ctrl-C or SIGTERM, and of its output, by a closed pipe."""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class Terminated(KeyboardInterrupt):
    """SIGTERM, which job schedulers and containers send before they kill a process."""


def exit_code(interruption: KeyboardInterrupt) -> int:
    """Returns the exit code of a command that was stopped: 128 plus the number of the signal, as in a shell."""
    return 143 if isinstance(interruption, Terminated) else 130


@contextmanager
def sigterm_as_ctrl_c() -> Iterator[None]:
    """Makes SIGTERM raise :class:`Terminated` in the context, so that a command saves what it has, as on Ctrl-C."""
    in_main_thread = threading.current_thread() is threading.main_thread()
    if not in_main_thread or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield  # a program that calls the command line handles its signals itself
        return
    signal.signal(signal.SIGTERM, _terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def discard_output() -> None:
    """Discards all further output, whose reader has closed it."""
    # Python would report the closed pipe again when it flushes at exit.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _terminate(number: int, _frame: Any) -> None:
    signal.signal(number, signal.SIG_IGN)  # a second one must not interrupt the saving
    raise Terminated
