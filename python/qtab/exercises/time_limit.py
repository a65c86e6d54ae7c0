"""A limit on the time of a call, which also ends a loop without an end.

A function of a notebook cannot be sent to another process, and Python has no way to end a thread. Instead, an exception
is raised inside the function, again and again in case it catches every exception. In the main thread of Linux and macOS
a timer's signal raises it, which also ends ``time.sleep`` and ``input``. On Windows, and in other threads, a second
thread raises it. It then appears only between two instructions of Python, so that a single call that never returns,
such as ``time.sleep``, is not ended. Neither ends a long computation in C, such as a product of huge matrices, before
it returns.
"""

import ctypes
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from types import FrameType
from typing import Any

REPEAT = 0.01
"""Seconds until the exception is raised again, if the function caught it."""


class TimeIsUp(BaseException):
    """The time limit was reached. It is not an ``Exception``, so that few functions catch it."""


def call_within(seconds: float, function: Callable[..., Any], arguments: Sequence[Any]) -> Any:
    """Calls a function; returns its result.

    Args:
        seconds: The time limit; it must be positive.
        function: The function.
        arguments: Its arguments.

    Raises:
        TimeIsUp: if it does not return in time.
    """
    is_main = threading.current_thread() is threading.main_thread()
    # A test runner may use the timer for its own limits.
    if sys.platform != "win32" and is_main and signal.getitimer(signal.ITIMER_REAL)[0] == 0.0:
        return _by_signal(seconds, function, arguments)
    return _by_thread(seconds, function, arguments)


def _by_signal(seconds: float, function: Callable[..., Any], arguments: Sequence[Any]) -> Any:
    active = True

    def interrupt(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 - Python's signature
        if active:
            raise TimeIsUp

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, seconds, REPEAT)
        return function(*arguments)
    finally:
        active = False  # first: the signal must not interrupt the next two lines
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _by_thread(seconds: float, function: Callable[..., Any], arguments: Sequence[Any]) -> Any:
    caller = ctypes.c_ulong(threading.get_ident())
    raise_in = ctypes.pythonapi.PyThreadState_SetAsyncExc
    active, lock = True, threading.Lock()
    begun, over = threading.Event(), threading.Event()

    def interrupt() -> None:
        begun.wait()  # otherwise the exception could appear before the try statement below
        pause = seconds
        while not over.wait(pause):
            with lock:
                if not active:
                    return
                raise_in(caller, ctypes.py_object(TimeIsUp))
            pause = REPEAT

    threading.Thread(target=interrupt, daemon=True).start()
    try:
        begun.set()
        return function(*arguments)
    finally:
        active = False  # first: an exception appears between calls, not in an assignment
        try:
            with lock:  # from here on no other exception can follow
                raise_in(caller, None)  # takes back one that has not appeared yet
        except TimeIsUp:
            pass
        over.set()
