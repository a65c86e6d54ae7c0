"""Python's own functions in compiled code: those that compute the same, with checks, and refusals of the others."""

import builtins
from typing import Any

from numba.core import ir, types

from qtab.compilation.checks.checked_operations import absolute, rounded, sum_of_integers, to_int
from qtab.compilation.checks.known_functions import BUILTINS
from qtab.compilation.checks.number_types import CONVERT, NUMBERS, is_int64, leaf, mixed, of_integers
from qtab.compilation.checks.typed_code import TypedCode


def is_builtin(function: Any) -> bool:
    """Returns whether a function is one of Python's own."""
    return function in vars(builtins).values()


def check_builtin(code: TypedCode, statement: Any, scope: Any, function: Any) -> list[Any]:
    """Returns the statements that check a call; the call may be replaced.

    Args:
        code: The code.
        statement: The assignment of the result.
        scope: The scope of its block.
        function: The function that is called.
    """
    expression = statement.value
    kinds = [types.unliteral(code.type_of(one)) for one in expression.args]
    if function is float and types.float32 in kinds:  # FloatCalls replaces those that are called by one constant
        return code.refuse(expression, "float of a float32 through a variable", "write np.float64(...)")
    if (refused := _refused(function, kinds, bool(expression.kws))) is not None:
        return code.refuse(expression, *refused)
    if function is abs and isinstance(kinds[0], types.Integer):
        return code.replace(statement, scope, absolute, expression.args, [types.int64])
    if function is sum and not isinstance(kinds[0], types.Array):
        return code.replace(statement, scope, sum_of_integers, expression.args, None)
    if function is round and isinstance(kinds[0], types.Integer):
        statement.value = ir.Expr.cast(expression.args[0], expression.loc)  # as a float it might be rounded
    elif function in (int, round) and len(kinds) == 1 and isinstance(kinds[0], types.Float):
        helper = to_int if function is int else rounded
        return code.replace(statement, scope, helper, expression.args, [types.float64])
    return []


def _refused(function: Any, kinds: list[Any], named: bool) -> tuple[str, str] | None:
    """Returns why a call is refused, and what to write instead; None if it is not."""
    name = function.__name__
    booleans = [isinstance(kind, types.Boolean) for kind in kinds]
    if function in (pow, divmod):
        return f"{name} can differ", "write products, or a // b and a % b"
    if function in (map, filter):
        return f"{name} is not checked in compiled code", "write [f(x) for x in values], or a loop"
    if name not in BUILTINS:
        return f"{name} may give another result in compiled code", "use numbers, tuples and arrays"
    if function is round and len(kinds) > 1:
        return "round with digits can differ", "write math.floor(x + 0.5)"
    if function in (min, max, abs, sum) and named:
        return f"{name} with named arguments", "compare or add the numbers in a loop"
    if function in (min, max, abs) and (reason := mixed([leaf(kind) for kind in kinds])):
        return reason, CONVERT
    if function in (abs, round) and booleans[0]:
        return f"{name} of a boolean", "convert it with int(...)"
    if function in (min, max) and len(kinds) == 1 and isinstance(kinds[0], NUMBERS):
        return f"{name} of a number", "give two numbers or more"
    if function in (min, max) and any(booleans) and not all(booleans):
        return f"{name} of a boolean and a number", "convert the boolean with int(...)"
    if function is range and not all(isinstance(kind, types.Integer) for kind in kinds):
        return f"range of {kinds[0]}", "convert it with int(...)"
    return _refused_sum(kinds) if function is sum else None


def _refused_sum(kinds: list[Any]) -> tuple[str, str] | None:
    of = kinds[0]
    if not of_integers(of):
        return "a sum of floats may be added in another order", "add in a loop"
    if isinstance(of, types.Set | types.DictType) or len(kinds) > 1:
        return f"a sum of {of}", "give a list of integers, and add the start to the sum"
    if isinstance(of, types.BaseTuple) and not isinstance(of, types.UniTuple) and not all(map(is_int64, of)):
        return "a sum of integers and booleans", "convert each with int(...)"
    return None
