"""Checks of arrays of numbers. Each error names the argument and counts the values that do not fit."""

import reprlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LARGEST = 1e150
"""The largest magnitude allowed for a number, so that sums of squares are finite."""

_SHORT = reprlib.Repr()
_SHORT.maxother = _SHORT.maxstring = 80


def shortened(value: Any) -> str:
    """Returns a value as text for an error message: one line of at most 100 characters."""
    line = " ".join(_SHORT.repr(value).split())
    return line if len(line) <= 100 else f"{line[:97]}..."


def numbers(name: str, values: Any) -> NDArray[np.float64]:
    """Returns the values of the argument ``name`` as a float64 array of any shape.

    Raises:
        TypeError: if the values are not real numbers.
        ValueError: if a value is NaN, infinite or larger than 1e150.
    """
    hint = ""
    if hasattr(values, "episode_returns"):
        hint = "; its episode_returns and final_returns() do"
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "biufO":
            raise TypeError
        with np.errstate(over="ignore"):
            array = array.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name} must hold numbers, got {shortened(values)}{hint}") from None
    not_finite = array.size - np.count_nonzero(np.isfinite(array))
    if not_finite:
        raise ValueError(f"{name} must be finite, got {not_finite:,} of {array.size:,} NaN or infinite")
    if array.size and max(array.max(), -array.min()) > LARGEST:
        raise ValueError(f"{name} must lie between -{LARGEST:g} and {LARGEST:g}, got {np.abs(array).max():g}")
    return array


def sample(name: str, values: ArrayLike, least: int = 1, purpose: str = "") -> NDArray[np.float64]:
    """Returns the values of the argument ``name`` as a float64 array (runs,).

    Args:
        name: The name of the argument.
        values: The value of the argument.
        least: The minimum number of values.
        purpose: The reason for the minimum, such as ``" for an interval"``.

    Raises:
        TypeError: if the values are not real numbers.
        ValueError: if the values have another shape, are fewer than ``least``, or are not finite.
    """
    array = numbers(name, values)
    if array.ndim != 1:
        raise ValueError(f"{name} must be one-dimensional, with one number per run, got shape {array.shape}")
    if len(array) < least:
        plural = "" if least == 1 else "s"
        raise ValueError(f"{name} must hold at least {least} number{plural}{purpose}, got {len(array)}")
    return array


def curves(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Returns the values of the argument ``name`` as a float64 array (runs, episodes); a single run may be (episodes,).

    Raises:
        TypeError: if the values are not real numbers.
        ValueError: if the values have another shape, are empty, or are not finite.
    """
    array = np.atleast_2d(numbers(name, values))
    if array.ndim != 2 or array.size == 0:
        raise ValueError(f"{name} must have the shape (runs, episodes) and not be empty, got {np.shape(values)}")
    return array


def is_table(values: Any) -> bool:
    """Returns whether the values are a two-dimensional array."""
    try:
        return np.ndim(values) == 2
    except ValueError:  # nested lists of different lengths
        return False


def same_bytes(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Returns whether two arrays of any shapes hold the same numbers in the same order, bit for bit."""
    return np.array_equal(one.ravel().view(np.uint64), other.ravel().view(np.uint64))
