"""Checks of arguments. Each error names the argument, states what would fit, and shows the value."""

import math
import operator
from collections.abc import Collection, Mapping, Set
from os import PathLike, fspath
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from qtab._utils.shown import did_you_mean, shown

T = TypeVar("T")

LARGEST_COUNT = 2**63 - 1
"""The largest number of episodes or steps, which are counted in 64 bits."""
MAX_THREADS = 1024
"""The maximum number of threads of a call, above any core count. Running out of threads would abort the process."""


def real(name: str, value: Any, low: float, high: float) -> float:
    """Returns ``value`` as a float in [``low``, ``high``].

    Raises:
        TypeError: if ``value`` is not a real number. Booleans are not accepted.
        ValueError: if ``value`` is NaN or outside the interval.
    """
    number = _number(value)
    if number is None:
        raise TypeError(f"{name} must be a number in [{low:g}, {high:g}], got {shown(value)}")
    if not low <= number <= high:
        raise ValueError(f"{name} must lie in [{low:g}, {high:g}], got {shown(value)}")
    return number


def finite(name: str, value: Any) -> float:
    """Returns ``value`` as a finite float.

    Raises:
        TypeError: if ``value`` is not a real number. Booleans are not accepted.
        ValueError: if ``value`` is NaN or infinite.
    """
    number = _number(value)
    if number is None:
        raise TypeError(f"{name} must be a finite number, got {shown(value)}")
    if not math.isfinite(number):
        raise ValueError(f"{name} must be finite, got {shown(value)}")
    return number


def _number(value: Any) -> float | None:
    """Returns a real number as a float, or infinity if it is too large for a float; None for anything else."""
    if type(value) is float:  # the usual case; the checks below take a microsecond
        return value
    if isinstance(value, (bool, np.bool_, str, bytes)) or not hasattr(value, "__float__") or np.ndim(value):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def integer(name: str, value: Any, least: int, most: int | None = None) -> int:
    """Returns ``value`` as a Python integer of at least ``least`` and at most ``most``.

    Raises:
        TypeError: if ``value`` is not an integer. Booleans and floats such as 5.0 are not accepted.
        ValueError: if ``value`` is too small or too large.
    """
    fits = f"an integer of at least {least}" if most is None else f"an integer from {least} to {most}"
    if isinstance(value, bool | np.bool_) or not hasattr(value, "__index__"):  # NumPy 2.0's booleans have an __index__
        raise TypeError(f"{name} must be {fits}, got {shown(value)}")
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be {fits}, got {shown(value)}") from None
    if number < least or (most is not None and number > most):
        raise ValueError(f"{name} must be {fits}, got {shown(value)}")
    return number


def count(name: str, value: Any, least: int) -> int:
    """Returns ``value`` as a Python integer of at least ``least`` that fits into 64 bits.

    Raises:
        TypeError: if ``value`` is not an integer. Booleans and floats such as 5.0 are not accepted.
        ValueError: if ``value`` is too small or too large.
    """
    number = integer(name, value, least)
    if number > LARGEST_COUNT:
        raise ValueError(f"{name} must be less than 2**63, got {shown(value)}")
    return number


def threads(value: Any) -> int:
    """Returns the value of the argument ``threads`` as a Python integer.

    Raises:
        TypeError: if ``value`` is not an integer. Booleans and floats such as 5.0 are not accepted.
        ValueError: if ``value`` is too small or too large.
    """
    return integer("threads", value, least=1, most=MAX_THREADS)


def is_sequence(value: Any) -> bool:
    """Returns whether a value is an ordered collection, not a string, a mapping or a set."""
    return hasattr(value, "__iter__") and not isinstance(value, str | bytes | Mapping | Set)


def boolean(name: str, value: Any) -> bool:
    """Returns ``value``, which must be True or False; NumPy's booleans become Python's.

    Raises:
        TypeError: if ``value`` is anything else, such as "no", which would count as true.
    """
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"{name} must be True or False, got {shown(value)}")
    return bool(value)


def choice(name: str, value: Any, choices: Collection[str]) -> str:
    """Returns ``value``, which must be one of ``choices``.

    Raises:
        TypeError: if ``value`` is not a string.
        ValueError: if ``value`` is another string.
    """
    if isinstance(value, str) and value in choices:
        return value
    words = ", ".join(map(repr, choices))
    message = f"{name} must be {'one of ' if len(choices) > 1 else ''}{words}, got {shown(value)}"
    if not isinstance(value, str):
        raise TypeError(message)
    raise ValueError(f"{message}{did_you_mean(value, choices)}")


def instance(name: str, value: Any, kind: type) -> None:
    """Checks that ``value`` is an instance of a class of this package.

    Raises:
        TypeError: if ``value`` is not an instance; for a path the message suggests :func:`qtab.load`.
    """
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIO" else "a"
        raise TypeError(
            f"{name} must be {article} {kind.__name__}, got {shown(value)}{load_hint(value)}{_runs_hint(value, kind)}"
        )


def path(name: str, value: Any) -> Path:
    """Returns a path.

    Raises:
        TypeError: if ``value`` is neither a string nor a path.
        ValueError: if ``value`` has a null character, which no path can have.
    """
    if not isinstance(value, str | PathLike) or not isinstance(fspath(value), str):
        raise TypeError(f"{name} must be a path, got {shown(value)}")
    if "\0" in fspath(value):
        raise ValueError(f"{name} must be a path, got {shown(fspath(value))}, which has a null character")
    return Path(value)


def file_path(name: str, value: Any) -> Path:
    """Returns the path of a file.

    Raises:
        TypeError: if ``value`` is neither a string nor a path.
        ValueError: if ``value`` is empty, which would be the current folder, or has a null character.
    """
    found = path(name, value)
    if not fspath(value):
        raise ValueError(f"{name} must name a file, got {shown(value)}")
    return found


def load_hint(value: Any) -> str:
    """Returns a hint for a path that was given instead of the content of its file; "" for other values."""
    return "; qtab.load reads one from a file" if isinstance(value, str | PathLike) else ""


def _runs_hint(value: Any, kind: type) -> str:
    """Returns a hint for several runs that were given instead of one; "" for other values."""
    if kind.__name__ != "Run" or type(value).__name__ != "Runs":
        return ""
    return "; pass one of them, as in `for run in runs`, after train_many(..., tables=True)"


def required(name: str, value: T | None) -> T:
    """Returns a setting that a complete config must have.

    Raises:
        ValueError: if ``value`` is None.
    """
    if value is None:
        raise ValueError(f"{name} must be given, got None")
    return value
