"""Functions of ``math``, which compiled code computes as Python does."""

import ast
import math
from typing import TYPE_CHECKING, Any

from qtab.compilation.checks.known_functions import MATH, MATH_ADVICE, MATH_ROUNDED, MATH_TESTS, MATH_TWO, OTHER_MATH
from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.library import Handler
from qtab.compilation.rewriting.program import as_float
from qtab.compilation.rewriting.values import BOOL, FLOAT, INT, WIDE, Value, in_words

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions


def _function(name: str) -> Handler:
    function = getattr(math, name)

    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if named or len(values) != (2 if name in MATH_TWO else 1):
            raise scope.refuse(node, f"math.{name} with these arguments", "give the numbers in order")
        if all(value.is_fixed for value in values):
            return scope.folded(node, function, *[value.fixed for value in values])
        lifted = [scope.lift(value, node) for value in values]
        if any(value.kind not in WIDE for value in lifted):
            wrong = next(value for value in lifted if value.kind not in WIDE)
            raise scope.refuse(node, f"math.{name} of {in_words(wrong.kind)}", "convert it: float(...)")
        # Integers are rounded as they are. NumPy's become floats, so that a check allows them up to 2**53.
        rounds = name in MATH_ROUNDED
        codes = [str(value.code) if rounds and value.kind == INT else as_float(value) for value in lifted]
        kind = BOOL if name in MATH_TESTS else INT if rounds else FLOAT
        return Value(kind, f"math.{name}({', '.join(codes)})")

    return handler


def refused(scope: "Expressions", node: ast.AST, function: Any) -> NotCompilable:
    """Returns the error for another function of ``math``."""
    name = function.__name__
    advice = MATH_ADVICE.get(name, OTHER_MATH)
    return scope.refuse(node, f"math.{name} may round differently in compiled code", advice)


TABLE: dict[Any, Handler] = {getattr(math, name): _function(name) for name in MATH}
"""The functions by object."""
