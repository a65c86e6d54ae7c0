"""``np.clip`` for rewritten code, with the zeros of the installed NumPy.

Where a number and a bound are zeros of opposite sign, NumPy before 2.4 returns the bound. Later versions return the
number, unless the bounds are arrays. The helpers do what the installed version did when it was tried. Where its result
depends on the size of the array, they raise an error, so that Python repeats the step.
"""

import math
from typing import Any

import numpy as np

NUMBER, BOUND, VARIES = "number", "bound", "varies"
LARGEST_SIZE = 33
"""The largest array that is tried: longer than the vectors of any processor."""


def winner(with_arrays: bool) -> str:
    """Returns which of two zeros of opposite sign ``np.clip`` returns: ``NUMBER``, ``BOUND``, or that it ``VARIES``.

    Args:
        with_arrays: Whether the bounds are arrays.
    """
    kept = set()
    for size in range(1, LARGEST_SIZE + 1):
        for number, low, high in ((0.0, -0.0, 1.0), (-0.0, 0.0, 1.0), (0.0, -1.0, -0.0), (-0.0, -1.0, 0.0)):
            bounds: list[Any] = [np.full(size, one) if with_arrays else one for one in (low, high)]
            clipped = [*np.clip(np.full(size, number), *bounds)]
            clipped += [] if with_arrays else [np.clip(number, *bounds), np.clip(np.float64(number), *bounds)]
            kept |= {math.copysign(1.0, one) == math.copysign(1.0, number) for one in clipped}
    return VARIES if len(kept) == 2 else NUMBER if kept == {True} else BOUND


def _number_wins() -> Any:
    def clip(value: Any, low: Any, high: Any) -> Any:
        raised = value if (value != value or value >= low) else low
        return raised if (raised != raised or raised <= high) else high

    return clip


def _bound_wins() -> Any:
    def clip(value: Any, low: Any, high: Any) -> Any:
        raised = value if (value != value or value > low) else low
        return raised if (raised != raised or raised < high) else high

    return clip


def _no_ties() -> Any:
    def clip(value: Any, low: Any, high: Any) -> Any:
        raised = value if (value != value or value > low) else low
        if value == low and math.copysign(1.0, value) != math.copysign(1.0, low):
            raise ValueError
        if raised == high and math.copysign(1.0, raised) != math.copysign(1.0, high):
            raise ValueError
        return raised if (raised != raised or raised < high) else high

    return clip


def clip_number(name: str, wins: str) -> Any:
    """Returns a function that clips one number.

    Args:
        name: Its name.
        wins: What ``winner`` returns.
    """
    made = {NUMBER: _number_wins, BOUND: _bound_wins, VARIES: _no_ties}[wins]()
    made.__name__ = made.__qualname__ = name
    return made


h_clip: Any = clip_number("h_clip", winner(with_arrays=False))
"""``np.clip`` with numbers as bounds."""
h_clip_between: Any = clip_number("h_clip_between", winner(with_arrays=True))
"""The same for an element of an array, with elements of arrays as bounds."""


def h_clip_array(values: Any, low: Any, high: Any) -> Any:
    """``np.clip`` for an array of any shape, with numbers as bounds."""
    clipped = values.copy()
    flat = clipped.reshape(clipped.size)
    for i in range(flat.size):
        flat[i] = h_clip(flat[i], low, high)
    return clipped


def h_clip_arrays(values: Any, low: Any, high: Any) -> Any:
    """``np.clip`` for an array of any shape, with contiguous arrays of its shape as bounds."""
    clipped = values.copy()
    flat, lows, highs = clipped.reshape(clipped.size), low.reshape(low.size), high.reshape(high.size)
    for i in range(flat.size):
        flat[i] = h_clip_between(flat[i], lows[i], highs[i])
    return clipped


def h_clip_vector(values: Any, low: Any, high: Any) -> Any:
    """``np.clip`` for a vector, with numbers as bounds; a loop compiles faster than functions of arrays."""
    clipped = np.empty(values.shape[0], values.dtype)
    for i in range(values.shape[0]):
        clipped[i] = h_clip(values[i], low, high)
    return clipped


def h_clip_vectors(values: Any, low: Any, high: Any) -> Any:
    """``np.clip`` for a vector, with vectors of its length as bounds."""
    clipped = np.empty(values.shape[0], values.dtype)
    for i in range(values.shape[0]):
        clipped[i] = h_clip_between(values[i], low[i], high[i])
    return clipped
