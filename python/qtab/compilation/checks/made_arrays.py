"""Checks of functions and operators that make arrays: numbers outside the range of a dtype raise errors in Python."""

import operator
from typing import Any

import numpy as np
from numba.core import types

from qtab.compilation.checks.checked_operations import (
    CLIP_CHECKS,
    FLOAT_RANGE_CHECKS,
    RANGE_CHECKS,
    compiled,
    exact_integer,
)
from qtab.compilation.checks.number_types import is_narrow
from qtab.compilation.checks.typed_code import TypedCode

VALUES = {"full": ("fill_value", 1), "full_like": ("fill_value", 1), "array": ("object", 0), "asarray": ("a", 0)}
"""Functions of NumPy that convert numbers, with the name and the position of these."""
_DIVISIONS = {operator.floordiv: "//", operator.mod: "%"}
_SHIFTS = {operator.lshift: "<<", operator.rshift: ">>"}


def check_made_array(code: TypedCode, statement: Any, scope: Any, name: str) -> list[Any]:
    """Returns the statements that check the numbers of an array that is made.

    Args:
        code: The code.
        statement: The assignment of the array.
        scope: The scope of its block.
        name: The function of NumPy.
    """
    expression = statement.value
    made = code.type_of(statement.target)
    if not isinstance(made, types.Array):
        return []
    if name == "clip":
        return _check_clip(code, expression, scope, made)
    if name == "arange" and is_narrow(made.dtype):
        return code.refuse(expression, f"np.arange with {made.dtype}", "write np.arange(...).astype(...)")
    if name == "arange" and _has_floats(code, expression):
        return code.refuse(expression, "np.arange of floats rounds differently", "write low + step * np.arange(n)")
    if name not in VALUES:
        return []
    word, position = VALUES[name]
    value = dict(expression.kws).get(word) or (expression.args[position] if len(expression.args) > position else None)
    if value is None:
        return []
    return check_numbers(code, scope, value, made.dtype, expression)


def _has_floats(code: TypedCode, expression: Any) -> bool:
    given = [*expression.args, *(one for _, one in expression.kws)]
    return any(isinstance(types.unliteral(code.type_of(one)), types.Float) for one in given)


def check_numbers(code: TypedCode, scope: Any, value: Any, dtype: Any, expression: Any) -> list[Any]:
    """Returns the statements that check a number, or the numbers of a sequence, which are converted to a dtype."""
    of = types.unliteral(code.type_of(value))
    if isinstance(of, types.Array):  # converted as NumPy does
        return []
    depth, leaf = _depth_and_leaf(of)
    if leaf is None:
        wrong = is_narrow(dtype) or dtype == types.float32
        what = f"an array of {dtype} made of numbers of several types"
        return code.refuse(expression, what, "give each number one type: int(...) or float(...)") if wrong else []
    check = check_of(dtype, leaf)
    if check is None:
        return []
    return code.check(_over(check, depth), scope, [value], expression.loc)


def check_of(dtype: Any, number: Any) -> Any:
    """Returns the function that checks a number before its conversion to a dtype; None if none is needed."""
    number = types.unliteral(number)
    if isinstance(number, types.Integer):
        if is_narrow(dtype):
            return RANGE_CHECKS[dtype]
        # Python converts its integers to float64 first, which rounds twice.
        return exact_integer if dtype == types.float32 and number == types.int64 else None
    return FLOAT_RANGE_CHECKS.get(dtype) if isinstance(number, types.Float) else None


def _depth_and_leaf(of: Any) -> tuple[int, Any]:
    """Returns how deep numbers are nested in sequences, and their type; None for several types."""
    of = types.unliteral(of)
    if isinstance(of, types.List | types.UniTuple | types.ListType):
        depth, leaf = _depth_and_leaf(of.dtype)
        return depth + 1, leaf
    if isinstance(of, types.BaseTuple):
        inner = {_depth_and_leaf(one) for one in of}
        depth, leaf = next(iter(inner)) if len(inner) == 1 else (0, None)
        return depth + 1, leaf
    return 0, of if isinstance(of, types.Integer | types.Float | types.Boolean) else None


_known: dict[tuple[int, int], Any] = {}


def _over(check: Any, depth: int) -> Any:
    """Returns a function that checks the numbers in nested sequences."""
    if depth == 0:
        return check
    key = id(check), depth
    if key not in _known:
        lines, name = ["def over(value):"], "value"
        for level in range(depth):
            lines.append("    " * (level + 1) + f"for item{level} in {name}:")
            name = f"item{level}"
        lines.append("    " * (depth + 1) + f"check({name})")
        scope: dict[str, Any] = {"check": check}
        exec("\n".join(lines), scope)  # noqa: S102 - code of this module
        _known[key] = compiled(scope["over"])
    return _known[key]


def _check_clip(code: TypedCode, expression: Any, scope: Any, made: Any) -> list[Any]:
    given = [types.unliteral(code.type_of(one)) for one in expression.args]
    if not isinstance(made.dtype, types.Float):
        return []
    if len(given) != 3 or expression.kws or any(isinstance(one, types.NoneType) for one in given):
        return code.refuse(expression, "np.clip without both bounds", "give both bounds, without names")
    arrays = [isinstance(one, types.Array) for one in given]
    if not arrays[0] or arrays[1] != arrays[2]:
        return code.refuse(expression, "np.clip: zeros may differ in sign", "write a loop with min(max(x, low), high)")
    return code.check(CLIP_CHECKS[arrays[1]], scope, list(expression.args), expression.loc)


def arrays_differ(function: Any, kinds: list[Any], right: Any) -> str:
    """Returns why the result of an operator of arrays can differ from NumPy's; an empty text if it does not.

    Args:
        function: The operator.
        kinds: The types of the numbers of both sides.
        right: The right side, if it is a constant; otherwise None.
    """
    symbol = {**_DIVISIONS, **_SHIFTS}.get(function)
    whole = all(isinstance(kind, types.Integer) for kind in kinds)
    positive = isinstance(right, int | np.ndarray) and bool(np.all(np.asarray(right) > 0))
    if symbol is None or (function in _DIVISIONS and whole and positive):  # neither undefined nor too large
        return ""
    return f"{symbol} of arrays differs for some numbers"
