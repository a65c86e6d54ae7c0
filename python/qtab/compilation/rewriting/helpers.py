"""Functions that rewritten code calls where Numba lacks one of NumPy's, compiles it slowly, or lacks a check.

They run in plain Python and under Numba, with the same results as what they replace. Names start with ``h_`` so that no
name of a program can be the same. Their arithmetic is compiled without checks, as integers of arrays wrap in NumPy.
"""

from types import FunctionType
from typing import Any

import numpy as np

from qtab.compilation.rewriting.library import clip_helpers


def h_store_vector(field: Any, values: Any) -> None:
    """Assigns a vector to an attribute; its length must stay the same."""
    if field.shape[0] != values.shape[0]:
        raise ValueError
    for i in range(values.shape[0]):
        field[i] = values[i]


def h_store_matrix(field: Any, values: Any) -> None:
    """Assigns a matrix to an attribute; its shape must stay the same."""
    if field.shape[0] != values.shape[0] or field.shape[1] != values.shape[1]:
        raise ValueError
    for i in range(values.shape[0]):
        for j in range(values.shape[1]):
            field[i, j] = values[i, j]


def h_equal_vectors(one: Any, other: Any) -> Any:
    """``np.array_equal`` of two vectors."""
    if one.shape[0] != other.shape[0]:
        return False
    for i in range(one.shape[0]):  # noqa: SIM110 - for Numba
        if one[i] != other[i]:
            return False
    return True


def h_store(field: Any, values: Any) -> None:
    """Assigns an array to an attribute; its shape must stay the same."""
    if field.shape != values.shape:
        raise ValueError
    field[:] = values


def h_index(key: Any, size: Any) -> Any:
    """Returns the index of an element of a sequence, counted from the end if it is negative."""
    index = key + size if key < 0 else key
    if index < 0 or index >= size:
        raise IndexError
    return index


def h_key(key: Any, size: Any) -> Any:
    """Returns the key of a dict whose keys are 0 to size - 1."""
    if key < 0 or key >= size:
        raise KeyError
    return key


def h_choice(cumulative: Any, draw: Any) -> Any:
    """Returns the index that ``Generator.choice`` draws with probabilities, given their cumulative sums."""
    index = 0
    while index < cumulative.size and cumulative[index] <= draw:
        index += 1
    return index


def h_equal(one: Any, other: Any) -> Any:
    """``np.array_equal``."""
    return one.shape == other.shape and np.all(one == other)


def h_argmax(values: Any) -> Any:
    """``np.argmax`` of a vector of integers or booleans."""
    best = 0
    for i in range(1, values.size):
        if values[i] > values[best]:
            best = i
    return best


def h_argmin(values: Any) -> Any:
    """``np.argmin`` of a vector of integers or booleans."""
    best = 0
    for i in range(1, values.size):
        if values[i] < values[best]:
            best = i
    return best


def is_helper(function: FunctionType) -> bool:
    """Returns whether a function of a program is not the user's, and is compiled without checks."""
    return function.__name__.startswith("h_")


HELPERS = {name: value for name, value in [*vars(clip_helpers).items(), *globals().items()] if name.startswith("h_")}
"""The helpers of rewritten code by name."""
