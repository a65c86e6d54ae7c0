"""Helpers that check the arguments of draws as NumPy does: Numba draws with any.

Where NumPy draws NaN, they raise an error too, and the step is repeated in Python.
"""

import math
from typing import Any


def h_not_negative(value: Any) -> Any:
    """Returns an argument of a draw that must be 0 or more; -0.0 is refused as by NumPy."""
    if not value >= 0 or math.copysign(1.0, float(value)) < 0:
        raise ValueError
    return value


def h_positive(value: Any) -> Any:
    """Returns an argument of a draw that must be more than 0."""
    if not value > 0:
        raise ValueError
    return value


def h_probability(value: Any) -> Any:
    """Returns an argument of a draw that must be from 0 to 1."""
    if not 0 <= value <= 1:
        raise ValueError
    return value


def h_positive_probability(value: Any) -> Any:
    """Returns an argument of a draw that must be more than 0, and at most 1.

    For the smallest numbers, the number that is drawn may not fit 64 bits.
    """
    if not 1e-9 <= value <= 1:
        raise ValueError
    return value


def h_poisson(value: Any) -> Any:
    """Returns the mean of a Poisson distribution; from 10 on, Numba's numbers can differ from NumPy's."""
    if not 0 <= value < 10:
        raise ValueError
    return value


def h_uniform(low: Any, high: Any) -> Any:
    """Returns the upper bound of a uniform distribution."""
    if not 0.0 <= float(high) - float(low) <= 1.7976931348623157e308:
        raise OverflowError
    return high


def h_triangular(left: Any, mode: Any, right: Any) -> Any:
    """Returns the largest number of a triangular distribution."""
    if not (left <= mode <= right and left < right):
        raise ValueError
    return right


HELPERS = {name: value for name, value in list(globals().items()) if name.startswith("h_")}
"""The helpers in this module by name."""
