"""Functions that compiled programs call, where compiled code differs from Python or lacks a check.

They run in plain Python and under Numba, with the same results as the functions that they replace. Names start with
``h_`` so that no name of a program can be the same.
"""

import math
from typing import Any

import numpy as np

from qtab.compilation.rewriting.helpers import draw_checks


def h_clip(value: Any, low: Any, high: Any) -> Any:
    """Does what ``np.clip`` does with numbers, also with zeros of either sign and with NaN."""
    raised = value if (value != value or value > low) else low
    return raised if (raised != raised or raised < high) else high


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
        flat[i] = h_clip(flat[i], lows[i], highs[i])
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
        clipped[i] = h_clip(values[i], low[i], high[i])
    return clipped


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


def h_checked(argument: Any, result: Any) -> Any:
    """Returns the result of a function of ``math``; raises an error where Python does."""
    if result != result and argument == argument:
        raise ValueError
    if math.isinf(result) and not math.isinf(argument):
        raise OverflowError
    return result


def h_within(value: Any, low: Any, high: Any) -> Any:
    """Returns a number that is stored in an array of small integers; raises an error where NumPy does."""
    if value < low or value > high:
        raise OverflowError
    return value


def h_flag(value: Any) -> Any:
    """Returns a number as a boolean; it must be 0 or 1."""
    if value != 0 and value != 1:
        raise ValueError
    return value != 0


def h_int(value: Any) -> Any:
    """``int`` of a float; raises an error for NaN, infinity and numbers of more than 63 bits."""
    if not (-9.2e18 < value < 9.2e18):
        raise ValueError
    return int(value)


def h_floor(value: Any) -> Any:
    """``math.floor``."""
    return h_int(np.floor(value))


def h_ceil(value: Any) -> Any:
    """``math.ceil``."""
    return h_int(np.ceil(value))


def h_trunc(value: Any) -> Any:
    """``math.trunc``."""
    return h_int(value)


def h_round(value: Any) -> Any:
    """``round`` of a float to an integer."""
    return h_int(np.rint(value))


def h_add(one: Any, other: Any) -> Any:
    """``one + other`` of integers; raises an error outside 64 bits.

    The tests come before the sum, as sums that overflow are undefined in compiled code, and do without -2**63, which
    Numba takes for a number without a sign.
    """
    if one > 9223372036854775807 - other if other > 0 else one < (-9223372036854775807 - other) - 1:
        raise OverflowError
    return one + other


def h_sub(one: Any, other: Any) -> Any:
    """``one - other`` of integers; raises an error outside 64 bits."""
    if one > 9223372036854775807 + other if other < 0 else one < (-9223372036854775807 + other) - 1:
        raise OverflowError
    return one - other


def h_mul(one: Any, other: Any) -> Any:
    """``one * other`` of integers; raises an error outside 64 bits."""
    if -2147483648 <= one <= 2147483647 and -2147483648 <= other <= 2147483647:
        return one * other
    if one > 0 and other > 0:
        fits = one <= 9223372036854775807 // other
    elif one > 0:
        fits = other >= (-9223372036854775807 + (one - 2)) // one
    elif other > 0:
        fits = one >= (-9223372036854775807 + (other - 2)) // other
    elif one == 0 or other == 0:
        fits = True
    else:
        fits = one >= -9223372036854775807 and other >= -9223372036854775807 and -one <= 9223372036854775807 // -other
    if not fits:
        raise OverflowError
    return one * other


def h_neg(value: Any) -> Any:
    """``-value`` of an integer; raises an error outside 64 bits."""
    if value < -9223372036854775807:
        raise OverflowError
    return -value


def h_abs(value: Any) -> Any:
    """``abs`` of an integer; raises an error outside 64 bits."""
    return h_neg(value) if value < 0 else value


def h_floordiv(one: Any, other: Any) -> Any:
    """``one // other`` of integers; raises an error outside 64 bits."""
    return h_neg(one) if other == -1 else one // other


def h_truediv(one: Any, other: Any) -> Any:
    """``one / other`` of integers; raises an error for those that no float holds exactly."""
    return h_exact(one) / h_exact(other)


def h_exact(value: Any) -> Any:
    """Returns an integer that a float holds exactly; raises an error for others."""
    if value < -9007199254740992 or value > 9007199254740992:
        raise OverflowError
    return value


def h_ipow(base: Any, exponent: Any) -> Any:
    """``base ** exponent`` of integers, the exponent not negative; raises an error outside 64 bits."""
    result = 1
    while exponent > 0:
        if exponent & 1:
            result = h_mul(result, base)
        exponent = exponent >> 1
        if exponent > 0:
            base = h_mul(base, base)
    return result


def h_shl(value: Any, count: Any) -> Any:
    """``value << count``; raises an error outside 64 bits."""
    if count < 0:
        raise ValueError
    if value == 0:
        return value
    if count > 63:
        raise OverflowError
    most = 9223372036854775807 >> count
    if value > most or value < -most - 1:
        raise OverflowError
    return value << count


def h_shr(value: Any, count: Any) -> Any:
    """``value >> count`` for any count that is not negative."""
    if count < 0:
        raise ValueError
    return value >> (count if count < 63 else 63)


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


HELPERS = {name: value for name, value in list(globals().items()) if name.startswith("h_")} | draw_checks.HELPERS
"""The helpers of rewritten code by name."""
