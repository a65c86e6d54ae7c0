"""Functions of NumPy and methods of arrays in compiled code, with checks, and refusals of those that can differ."""

from typing import Any

import numpy as np
from numba.core import types

from qtab.compilation.checks.known_functions import (
    NUMPY_DIFFERENT,
    NUMPY_EXTREMES,
    NUMPY_JOINS,
    NUMPY_OF_BOOLEANS,
    NUMPY_OPERATORS,
    NUMPY_SAME,
    NUMPY_SORTS,
    NUMPY_SUMS,
    NUMPY_SUMS_OF_INTEGERS,
    NUMPY_WRITES,
)
from qtab.compilation.checks.made_arrays import check_made_array, check_numbers
from qtab.compilation.checks.number_types import (
    CONVERT,
    NUMBERS,
    is_narrow,
    leaf,
    mixed,
    of_integers,
    wide_instead,
)
from qtab.compilation.checks.typed_code import TypedCode


def check_numpy_call(code: TypedCode, statement: Any, scope: Any, function: Any, name: str) -> list[Any]:
    """Returns the statements that check a call of a function of NumPy.

    Args:
        code: The code.
        statement: The assignment of the result.
        scope: The scope of its block.
        function: The function.
        name: Its name.
    """
    expression = statement.value
    given = [code.type_of(one) for one in expression.args]
    kinds = [kind for kind in map(leaf, given) if isinstance(kind, NUMBERS)]
    reason, advice = "", ""
    if name in NUMPY_OPERATORS:
        reason, advice = f"np.{name} differs for some numbers", NUMPY_OPERATORS[name]
    elif name in NUMPY_EXTREMES and not all(isinstance(kind, types.Integer) for kind in kinds):
        reason, advice = f"np.{name}: zeros may differ in sign", NUMPY_EXTREMES[name]
    elif name in NUMPY_DIFFERENT or (name in ("sin", "cos") and types.float32 in kinds):
        reason = f"np.{name} rounds differently in compiled code"
        advice = NUMPY_DIFFERENT.get(name, f"write math.{name}")
    elif name in NUMPY_WRITES:
        reason, advice = f"np.{name} can change an array of self", "assign to the elements in a loop"
    elif name in NUMPY_SUMS and not _adds_exactly(name, given):
        reason, advice = f"np.{name} may add in another order", "add in a loop"
    elif name in NUMPY_SORTS and not _sorts_exactly(name, given):
        reason, advice = f"np.{name}: equal elements may change their order", NUMPY_SORTS[name]
    elif isinstance(function, np.ufunc) and len(given) > function.nin:
        reason, advice = f"np.{name} with an array for the result", "assign the result"
    elif isinstance(function, np.ufunc) and _has_booleans(kinds) and name not in NUMPY_OF_BOOLEANS:
        reason, advice = f"np.{name} of booleans", "convert them with int(...) or array.astype(np.int64)"
    elif (isinstance(function, np.ufunc) or name in NUMPY_JOINS) and (types_differ := mixed(kinds)):
        reason, advice = f"np.{name}: {types_differ}", CONVERT
    elif name not in (*NUMPY_SAME, *NUMPY_EXTREMES, *NUMPY_SORTS, *NUMPY_SUMS):
        reason, advice = f"np.{name} may give another result in compiled code", "write a loop over the elements"
    if reason:
        return code.refuse(expression, reason, advice)
    return check_made_array(code, statement, scope, name)


def check_array_method(code: TypedCode, expression: Any, scope: Any, name: str, of: Any) -> list[Any]:
    """Returns the statements that check a call of a method of an array.

    Args:
        code: The code.
        expression: The call.
        scope: The scope of its block.
        name: The name of the method.
        of: The type of the array.
    """
    if name in NUMPY_SUMS and not _adds_exactly(name, [of]):
        return code.refuse(expression, f"array.{name}() may add in another order", "add in a loop")
    if name in ("min", "max") and not of_integers(of):
        return code.refuse(expression, f"array.{name}(): zeros may differ in sign", NUMPY_EXTREMES[name])
    if name in NUMPY_SORTS and not _sorts_exactly(name, [of]):
        return code.refuse(expression, f"array.{name}: equal elements may change their order", NUMPY_SORTS[name])
    if name in ("sort", "fill", "partition", "put", "itemset") and not of.mutable:
        return code.refuse(expression, f"array.{name}() changes an array of self", "copy the array first")
    if name == "item" and (is_narrow(of.dtype) or of.dtype == types.float32):
        return code.refuse(expression, f"array.item() of {of.dtype} keeps its dtype", wide_instead(of.dtype))
    if name == "view":
        return code.refuse(expression, "array.view() shows the sign of a NaN", "convert it with array.astype(...)")
    if name == "fill" and expression.args:
        return check_numbers(code, scope, expression.args[0], of.dtype, expression)
    return []


def _adds_exactly(name: str, given: list[Any]) -> bool:
    return name in NUMPY_SUMS_OF_INTEGERS and bool(given) and of_integers(given[0])


def _sorts_exactly(name: str, given: list[Any]) -> bool:
    return "arg" not in name and bool(given) and of_integers(given[0])


def _has_booleans(kinds: list[Any]) -> bool:
    return any(isinstance(kind, types.Boolean) for kind in kinds)
