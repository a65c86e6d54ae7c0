"""The columns of tables of results: NumPy arrays that keep every value as it is."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

_EXACT_IN_FLOATS = 2**53
"""Up to this size every integer is a float."""


def integer_column(values: Sequence[int]) -> NDArray[Any]:
    """Returns (n,) integers: int64 if all fit, else uint64 if all fit, else Python integers in an object array."""
    low, high = min(values, default=0), max(values, default=0)
    for dtype in (np.int64, np.uint64):
        if np.iinfo(dtype).min <= low and high <= np.iinfo(dtype).max:
            return np.array(values, dtype)
    return _object_column(values)


def cell_column(values: Sequence[Any]) -> NDArray[Any]:
    """Returns (n,) numbers, strings, booleans and None, in an object array if their types differ.

    Integers are as :func:`integer_column` returns them. Integers and floats together are float64, unless that rounds an
    integer.
    """
    types = {type(value) for value in values}
    if types == {int}:
        return integer_column(values)
    if types == {int, float}:
        if any(isinstance(value, int) and abs(value) > _EXACT_IN_FLOATS for value in values):
            return _object_column(values)
        return np.array(values, np.float64)
    return np.array(values) if len(types) == 1 else _object_column(values)


def _object_column(values: Sequence[Any]) -> NDArray[np.object_]:
    column = np.empty(len(values), dtype=np.object_)
    column[:] = values
    return column
