"""Operations for compiled code that raise an error where Python does, or where Python's integer has more than 64 bits.

A step in which one of them raises an error is repeated by Python.
"""

import math
import operator
from typing import Any

import numba
import numpy as np
from numba.core import types
from numba.extending import intrinsic

from qtab.compilation.checks.known_functions import (
    DRAWS,
    MATH_CHECKED,
    MATH_ROUNDED,
    MATH_TWO,
    draw_check,
)
from qtab.compilation.checks.known_functions import MATH as MATH_NAMES

OPTIONS: dict[str, Any] = {
    "boundscheck": True,
    "error_model": "python",
    "fastmath": False,
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
"""An index out of bounds is an error, and so is a division by zero; floating-point operations keep their order. The
functions are never called from Python, so that they need no wrappers."""

LARGEST_EXACT = 2**53
"""Integers up to this size are converted to floats without rounding."""


def _with_overflow(name: str) -> Any:
    def operation(_typing: Any, _one: Any, _other: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            result = getattr(builder, f"{name}_with_overflow")(*arguments)
            values = [builder.extract_value(result, i) for i in range(2)]
            return context.make_tuple(builder, signature.return_type, values)

        return types.Tuple((types.int64, types.boolean))(types.int64, types.int64), codegen

    return intrinsic(operation)


def _exact(name: str) -> Any:
    compute = _with_overflow(name)

    def exact(one: Any, other: Any) -> Any:
        result, overflows = compute(one, other)
        if overflows:
            raise OverflowError
        return result

    return compiled(exact)


def compiled(function: Any) -> Any:
    """Returns a function for compiled code."""
    return numba.njit(**OPTIONS)(function)


_add: Any = _exact("sadd")
_subtract: Any = _exact("ssub")
_multiply: Any = _exact("smul")


def _shift_left(one: Any, other: Any) -> Any:
    if other < 0:
        raise ValueError
    if one == 0:
        return one
    if other > 63:
        raise OverflowError
    result = one << other
    if result >> other != one:
        raise OverflowError
    return result


def _shift_right(one: Any, other: Any) -> Any:
    if other < 0:
        raise ValueError
    return one >> min(other, 63)


def _divide(one: Any, other: Any) -> Any:
    if one > LARGEST_EXACT or one < -LARGEST_EXACT or other > LARGEST_EXACT or other < -LARGEST_EXACT:
        raise OverflowError
    return one / other


def _floor_divide(one: Any, other: Any) -> Any:
    if other == -1:
        return _subtract(0, one)
    return one // other


def _remainder(one: Any, other: Any) -> Any:
    if other == -1:
        return 0
    return one % other


def _power(one: Any, other: Any) -> Any:
    if other < 0:
        raise ValueError
    result = 1
    while other > 0:
        if other & 1:
            result = _multiply(result, one)
        other = other >> 1
        if other > 0:
            one = _multiply(one, one)
    return result


INTEGER_OPERATIONS: dict[Any, Any] = {
    operator.add: _add,
    operator.sub: _subtract,
    operator.mul: _multiply,
    operator.lshift: compiled(_shift_left),
    operator.rshift: compiled(_shift_right),
    operator.truediv: compiled(_divide),
    operator.floordiv: compiled(_floor_divide),
    operator.mod: compiled(_remainder),
    operator.pow: compiled(_power),
}
"""Operations of two int64 by their operators."""


def _negative(value: Any) -> Any:
    return _subtract(0, value)


negative: Any = compiled(_negative)
"""``-value`` of an int64."""


def _absolute(value: Any) -> Any:
    return negative(value) if value < 0 else value


absolute: Any = compiled(_absolute)
"""``abs`` of an int64."""


def _sum_of_integers(values: Any) -> Any:
    total = 0
    for value in values:
        total = _add(total, np.int64(value))
    return total


sum_of_integers: Any = compiled(_sum_of_integers)
"""``sum`` of a list or a tuple of integers of one type, or of booleans."""


def _range_check(low: int, high: int) -> Any:
    source = f"def check(value):\n    if value < {low} or value > {high}:\n        raise OverflowError\n"
    scope: dict[str, Any] = {}
    exec(source, scope)  # noqa: S102 - code of this module
    return compiled(scope["check"])


exact_integer: Any = _range_check(-LARGEST_EXACT, LARGEST_EXACT)
"""Raises an error for an integer that is no float."""
exact_float: Any = _range_check(1 - LARGEST_EXACT, LARGEST_EXACT - 1)
"""Raises an error for a float that was computed from integers, if the result may have been rounded."""
RANGE_CHECKS: dict[Any, Any] = {
    numba.from_dtype(np.dtype(name)): _range_check(int(np.iinfo(name).min), min(int(np.iinfo(name).max), 2**63 - 1))
    for name in ("int8", "int16", "int32", "uint8", "uint16", "uint32", "uint64")
}
"""Functions that raise an error for integers outside the range of a type."""


def _not_nan(value: Any) -> Any:
    if value != value:
        raise ValueError


not_nan: Any = compiled(_not_nan)
"""Raises an error for NaN."""


def _float_range_check(name: str) -> Any:
    low, high = int(np.iinfo(name).min) - 1, min(int(np.iinfo(name).max), 2**63 - 1) + 1
    source = f"def check(value):\n    if not ({float(low)!r} < value < {float(high)!r}):\n        raise OverflowError\n"
    scope: dict[str, Any] = {}
    exec(source, scope)  # noqa: S102 - code of this module
    return compiled(scope["check"])


FLOAT_RANGE_CHECKS: dict[Any, Any] = {
    numba.from_dtype(np.dtype(name)): _float_range_check(name)
    for name in ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64")
}
"""Functions that raise an error for floats whose integer part is outside the range of a type, and for NaN."""


def _to_int(value: Any) -> Any:
    if not (-9.2e18 < value < 9.2e18):
        raise ValueError
    return np.int64(value)


to_int: Any = compiled(_to_int)
"""``int`` of a float."""


def _round(value: Any) -> Any:
    return to_int(np.rint(value))


rounded: Any = compiled(_round)
"""``round`` of a float to an integer."""


def _defined(argument: Any, result: Any) -> Any:
    if result != result and argument == argument:
        raise ValueError
    if math.isinf(result) and not math.isinf(argument):
        raise OverflowError
    return result


def _math_function(name: str) -> Any:
    scope: dict[str, Any] = {"math": math, "np": np, "defined": compiled(_defined), "to_int": to_int}
    smallest = {"log": "0.0", "log10": "0.0", "log2": "0.0", "log1p": "-1.0"}
    if name in MATH_TWO:
        # The sign of a NaN depends on the order of operations, and on the processor.
        check = "    if z != z:\n        raise ValueError\n" if name == "copysign" else ""
        source = f"def f(x, y):\n    z = np.float64(y)\n{check}    return math.{name}(np.float64(x), z)\n"
    else:
        condition = f"z <= {smallest[name]}" if name in smallest else "z < 0.0" if name == "sqrt" else ""
        check = f"    if {condition}:\n        raise ValueError\n" if condition else ""
        result = f"math.{name}(z)"
        if name in MATH_ROUNDED:
            result = "to_int(z)" if name == "trunc" else f"to_int(np.{name}(z))"
        elif name in MATH_CHECKED and not condition:
            result = f"defined(z, {result})"
        source = f"def f(x):\n    z = np.float64(x)\n{check}    return {result}\n"
    exec(source, scope)  # noqa: S102 - code of this module
    return compiled(scope["f"])


def _clip_check(with_arrays: bool) -> Any:
    counted = """        if number == 0.0:
            plus, minus = plus or math.copysign(1.0, number) > 0.0, minus or math.copysign(1.0, number) < 0.0
"""
    nan = "        if number != number:\n            raise ValueError\n"
    loops = [
        f"    for number in {one}:\n{nan}{counted}"
        for one in (["low.flat", "high.flat"] if with_arrays else ["(float(low), float(high))"])
    ]
    source = f"""def check(values, low, high):
    plus = minus = False
{"".join(loops)}    if not (plus or minus):
        return
    for number in values.flat:
{counted}    if plus and minus:
        raise ValueError
"""
    scope: dict[str, Any] = {"math": math}
    exec(source, scope)  # noqa: S102 - code of this module
    return compiled(scope["check"])


CLIP_CHECKS = {with_arrays: _clip_check(with_arrays) for with_arrays in (False, True)}
"""Functions of the arguments of ``np.clip``, whose bounds are numbers (False) or arrays (True). They raise an error
where a bound is NaN, or where a zero may be replaced by one of the other sign: which of them is the result depends on
the version of NumPy."""

MATH: dict[Any, Any] = {getattr(math, name): _math_function(name) for name in MATH_NAMES}
"""Functions of ``math`` whose results have the same bits, with checks."""

INPLACE = {
    getattr(operator, f"i{name}"): getattr(operator, name)
    for name in ("add", "sub", "mul", "lshift", "rshift", "truediv", "floordiv", "mod", "pow", "matmul")
}
"""The operators of augmented assignments, and those that they stand for."""


DRAW_CHECKS: dict[str, Any] = {
    name: compiled(draw_check(name)) for name, (_, condition) in DRAWS.items() if condition != "True"
}
"""Functions of the arguments of a draw, which raise an error if NumPy may do so."""
