"""Calls a solution, and turns whatever goes wrong into a sentence for the student."""

import inspect
import random
import traceback
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from qtab.exercises.record import Misuse, Record
from qtab.exercises.time_limit import TimeIsUp, call_within

GLOBAL_NUMPY = (
    "it uses NumPy's global generator (np.random.random, np.random.seed, ...): draw all random numbers from rng"
)
GLOBAL_PYTHON = "it uses Python's global generator (the module random): draw all random numbers from rng"


def guarded(function: Callable[..., Any], arguments: Mapping[str, Any], record: Record, seconds: float) -> Any:
    """Calls a function; returns its result.

    The states of the global generators and NumPy's error handling are the same afterwards.

    Args:
        function: The function.
        arguments: Its arguments in order, with their names in the exercise. They are passed by position.
        record: Receives the faults of a call that returned, and whether it was stopped.
        seconds: The time limit.

    Raises:
        Misuse: if the function raises an exception, does not return in time, or is a generator function.
    """
    check_parameters(function, list(arguments))
    if inspect.isgeneratorfunction(function):
        raise Misuse("it contains yield, so that a call only makes a generator and runs nothing: remove the yield")
    numpy_before, python_before = np.random.get_state(legacy=False), random.getstate()  # noqa: NPY002
    try:
        with np.errstate():
            return call_within(seconds, function, list(arguments.values()))
    except Misuse:
        raise
    except TimeIsUp as error:
        record.was_stopped = True
        limit = f"{seconds:g} second{'' if seconds == 1 else 's'}"
        raise Misuse(
            f"it was stopped after {limit} (is there a loop that never ends?){_line(function, error)}"
        ) from None
    except (Exception, SystemExit) as error:
        hint = _hint(error) if "env" in arguments else ""
        raise Misuse(f"it raised {_named(error)}{_line(function, error)}{hint}") from None
    finally:
        if not _same_state(numpy_before, np.random.get_state(legacy=False)):  # noqa: NPY002
            _add(record, GLOBAL_NUMPY)
            np.random.set_state(numpy_before)  # noqa: NPY002
        if random.getstate() != python_before:
            _add(record, GLOBAL_PYTHON)
            random.setstate(python_before)


def _add(record: Record, fault: str) -> None:
    """Adds a fault, unless an earlier call of the check had it."""
    if fault not in record.faults:
        record.faults.append(fault)


def check_parameters(function: Callable[..., Any], names: Sequence[str]) -> None:
    """Checks that a function takes so many arguments, and that those with the names of the exercise are in its order.

    Raises:
        Misuse: if it does not.
    """
    wanted = f"{len(names)} arguments in this order: ({', '.join(names)})"
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):  # a function in C
        return
    try:
        signature.bind(*names)
    except TypeError:
        raise Misuse(f"it must take {wanted}, but takes {signature}") from None
    taken = list(signature.parameters)
    if sorted(taken) == sorted(names) and taken != list(names):
        raise Misuse(f"it must take {wanted}, but takes {signature}")


def _same_state(one: Any, other: Any) -> bool:
    return bool(
        one["state"]["pos"] == other["state"]["pos"] and np.array_equal(one["state"]["key"], other["state"]["key"])
    )


def _named(error: BaseException) -> str:
    message = str(error)
    return f"{type(error).__name__}: {message}" if message else type(error).__name__


def _hint(error: BaseException) -> str:
    """Returns a remark on Gymnasium's functions, if an error is typical of a wrong use of their results."""
    message = str(error)
    if isinstance(error, ValueError) and message.startswith("too many values to unpack (expected"):
        return ". env.step returns five values: next_state, reward, terminated, truncated, info"
    if message.startswith(("only integers, slices", "setting an array element with a sequence")):
        return ". env.reset() returns two values: state, info = env.reset()"
    return ""


def _line(function: Callable[..., Any], error: BaseException) -> str:
    """Returns the last line of the student's file, or cell, that led to an error."""
    code = getattr(inspect.unwrap(function), "__code__", None)
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if code is not None and frame.filename == code.co_filename]
    if not own:
        return ""
    return f", in line {own[-1].lineno}" + (f": {own[-1].line}" if own[-1].line else "")
