"""Functions for compiled code that raise an error where Python does, or where 64 bits are too few for Python's integer.

A step in which one of them raises an error is repeated by Python.
"""

import math
import operator
from typing import Any

import numba
import numpy as np
from numba.core import types
from numba.extending import intrinsic

from qtab.compilation.rewriting.helpers.helpers import h_checked
from qtab.compilation.rewriting.library.math_functions import CHECKED, ROUNDED, TESTS, TWO

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

    return _compiled(exact)


def _compiled(function: Any) -> Any:
    return numba.njit(**OPTIONS)(function)


_checked: Any = _compiled(h_checked)
_multiply: Any = _exact("smul")


def _shift_left(one: Any, other: Any) -> Any:
    if other < 0 or other > 62:
        raise ValueError
    result = one << other
    if result >> other != one:
        raise OverflowError
    return result


def _shift_right(one: Any, other: Any) -> Any:
    if other < 0 or other > 63:
        raise ValueError
    return one >> other


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
    for _ in range(other):
        result = _multiply(result, one)
    return result


_subtract: Any = _exact("ssub")

INTEGER_OPERATIONS: dict[Any, Any] = {
    operator.add: _exact("sadd"),
    operator.sub: _subtract,
    operator.mul: _multiply,
    operator.lshift: _compiled(_shift_left),
    operator.rshift: _compiled(_shift_right),
    operator.truediv: _compiled(_divide),
    operator.floordiv: _compiled(_floor_divide),
    operator.mod: _compiled(_remainder),
    operator.pow: _compiled(_power),
}
"""Operations of two int64 by their operators."""


def _range_check(low: int, high: int) -> Any:
    source = f"def check(value):\n    if value < {low} or value > {high}:\n        raise OverflowError\n"
    scope: dict[str, Any] = {}
    exec(source, scope)  # noqa: S102 - code of this module
    return _compiled(scope["check"])


exact_integer: Any = _range_check(-LARGEST_EXACT, LARGEST_EXACT)
"""Raises an error for an integer that is no float."""
RANGE_CHECKS: dict[Any, Any] = {
    numba.from_dtype(np.dtype(name)): _range_check(int(np.iinfo(name).min), min(int(np.iinfo(name).max), 2**63 - 1))
    for name in ("int8", "int16", "int32", "uint8", "uint16", "uint32", "uint64")
}
"""Functions that raise an error for integers outside the range of a type."""


def _to_int(value: Any) -> Any:
    if not (-9.2e18 < value < 9.2e18):
        raise ValueError
    return np.int64(value)


to_int: Any = _compiled(_to_int)
"""``int`` of a float."""


def _exact_int(value: Any) -> Any:
    """Returns a float as an integer; an integer beyond 2**53 has been rounded before."""
    if not (-9007199254740992.0 <= value <= 9007199254740992.0):
        raise OverflowError
    return np.int64(value)


def _round(value: Any) -> Any:
    return to_int(np.rint(value))


rounded: Any = _compiled(_round)
"""``round`` of a float to an integer."""


def _math_function(name: str) -> Any:
    scope: dict[str, Any] = {"math": math, "np": np, "checked": _checked, "exact": _compiled(_exact_int)}
    conditions = {"log": "x <= 0.0", "log10": "x <= 0.0", "log2": "x <= 0.0", "log1p": "x <= -1.0", "sqrt": "x < 0.0"}
    if name in TWO:
        source = f"def f(x, y):\n    return math.{name}(np.float64(x), np.float64(y))\n"
    else:
        result = f"math.{name}(z)"
        if name in ROUNDED:
            result = "exact(z)" if name == "trunc" else f"exact(np.{name}(z))"
        elif name not in (*TESTS, "fabs", *conditions):
            result = f"checked(z, {result})"
        check = (
            f"    if {conditions[name].replace('x', 'z')}:\n        raise ValueError\n" if name in conditions else ""
        )
        source = f"def f(x):\n    z = np.float64(x)\n{check}    return {result}\n"
    exec(source, scope)  # noqa: S102 - code of this module
    return _compiled(scope["f"])


MATH: dict[Any, Any] = {
    getattr(math, name): _math_function(name)
    for name in (*CHECKED, *TESTS, *ROUNDED, *TWO, "fabs", "log1p", "expm1", "log2")
}
"""Functions of ``math`` whose results have the same bits, with checks."""

_POSITIVE = "{} > 0.0"
_NOT_NEGATIVE = "({0} >= 0.0 and math.copysign(1.0, {0}) > 0.0)"
_SHARE = "0.0 < {} <= 1.0"
DRAWS: dict[str, tuple[str, str]] = {
    "normal": ("loc=0.0, scale=1.0, size=None", _NOT_NEGATIVE.format("scale")),
    "lognormal": ("mean=0.0, sigma=1.0, size=None", _NOT_NEGATIVE.format("sigma")),
    "logistic": ("loc=0.0, scale=1.0, size=None", _NOT_NEGATIVE.format("scale")),
    "laplace": ("loc=0.0, scale=1.0, size=None", _NOT_NEGATIVE.format("scale")),
    "exponential": ("scale=1.0, size=None", _NOT_NEGATIVE.format("scale")),
    "rayleigh": ("scale=1.0, size=None", _NOT_NEGATIVE.format("scale")),
    "gamma": ("shape, scale=1.0, size=None", "shape >= 0.0 and scale >= 0.0"),
    "standard_gamma": ("shape, size=None", _NOT_NEGATIVE.format("shape")),
    "weibull": ("a, size=None", _NOT_NEGATIVE.format("a")),
    "pareto": ("a, size=None", _POSITIVE.format("a")),
    "standard_t": ("df, size=None", _POSITIVE.format("df")),
    "chisquare": ("df, size=None", _POSITIVE.format("df")),
    "f": ("dfnum, dfden, size=None", "dfnum > 0.0 and dfden > 0.0"),
    "noncentral_chisquare": ("df, nonc, size=None", "df > 0.0 and nonc >= 0.0"),
    "noncentral_f": ("dfnum, dfden, nonc, size=None", "dfnum > 0.0 and dfden > 0.0 and nonc >= 0.0"),
    "beta": ("a, b, size=None", "a > 0.0 and b > 0.0"),
    "triangular": ("left, mode, right, size=None", "left <= mode <= right and left < right"),
    "uniform": ("low=0.0, high=1.0, size=None", "0.0 <= high - low < math.inf"),
    "poisson": ("lam=1.0, size=None", "0.0 <= lam < 10.0"),  # beyond that, Numba's own algorithm differs
    "geometric": ("p, size=None", "1e-9 <= p <= 1.0"),  # below, the numbers may not fit 64 bits
    "binomial": ("n, p, size=None", "n >= 0 and 0.0 <= p <= 1.0"),
    "logseries": ("p, size=None", "0.0 < p < 1.0"),
    "zipf": ("a, size=None", "1.0 < a < 1e9"),
}
"""The parameters of methods of generators, and the condition for which NumPy draws."""


INPLACE = {
    getattr(operator, f"i{name}"): getattr(operator, name)
    for name in ("add", "sub", "mul", "lshift", "rshift", "truediv", "floordiv", "mod", "pow", "matmul")
}
"""The operators of augmented assignments, and those that they stand for."""


def _draw_check(parameters: str, condition: str) -> Any:
    scope: dict[str, Any] = {"math": math}
    exec(f"def check({parameters}):\n    if not ({condition}):\n        raise ValueError\n", scope)  # noqa: S102
    return _compiled(scope["check"])


DRAW_CHECKS: dict[str, Any] = {name: _draw_check(*given) for name, given in DRAWS.items()}
"""Functions of the arguments of a draw, which raise an error if NumPy may do so."""
