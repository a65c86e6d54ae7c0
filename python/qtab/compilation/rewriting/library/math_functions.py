"""Functions of ``math``, which compiled code computes as Python does."""

import ast
import math
from typing import TYPE_CHECKING, Any

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.library import Handler
from qtab.compilation.rewriting.program import as_float
from qtab.compilation.rewriting.values import BOOL, FLOAT, INT, WIDE, Value, in_words

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

CHECKED = ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "log10", "sqrt", "sinh", "cosh", "tanh")
"""Functions that raise an error for some numbers."""
TESTS = ("isnan", "isinf", "isfinite")
ROUNDED = ("floor", "ceil", "trunc")
TWO = ("atan2", "copysign")


def _function(name: str) -> Handler:
    function = getattr(math, name)

    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if named or len(values) != (2 if name in TWO else 1):
            raise scope.refuse(node, f"math.{name} with these arguments", "give the numbers in order")
        if all(value.is_fixed for value in values):
            return scope.folded(node, function, *[value.fixed for value in values])
        lifted = [scope.lift(value, node) for value in values]
        if any(value.kind not in WIDE for value in lifted):
            wrong = next(value for value in lifted if value.kind not in WIDE)
            raise scope.refuse(node, f"math.{name} of {in_words(wrong.kind)}", "convert it: float(...)")
        effects = any(value.effects for value in lifted)
        codes = [as_float(value) for value in lifted]
        if name in TESTS:
            return Value(BOOL, f"math.{name}({codes[0]})", effects=effects)
        if name in ROUNDED:
            scope.compiled.uses |= {f"h_{name}", "h_int"}
            return Value(INT, f"h_{name}({codes[0]})", effects=effects)
        if name in TWO or name == "fabs":
            return Value(FLOAT, f"math.{name}({', '.join(codes)})", effects=effects)
        return Value(FLOAT, _checked(scope, name, codes[0]), effects=effects)

    return handler


def _checked(scope: "Expressions", name: str, code: str) -> str:
    helper = f"f_math_{name}"
    if helper not in scope.program.named:
        lines = [f"def {helper}(x):", f"    return h_checked(x, math.{name}(x))"]
        if name in ("log", "log10"):
            lines = [f"def {helper}(x):", "    if x <= 0.0:", "        raise ValueError", f"    return math.{name}(x)"]
        elif name == "sqrt":
            lines = [f"def {helper}(x):", "    if x < 0.0:", "        raise ValueError", "    return math.sqrt(x)"]
        scope.program.add(helper, lines, uses={"h_checked"})
    scope.compiled.uses.add(helper)
    return f"{helper}({code})"


def checked(scope: "Expressions", name: str, value: Value) -> Value:
    """Returns ``math.name(value)``."""
    return Value(FLOAT, _checked(scope, name, as_float(value)), effects=value.effects)


def refused(scope: "Expressions", node: ast.AST, function: Any) -> NotCompilable:
    """Returns the error for another function of ``math``."""
    name = function.__name__
    advice = {
        "pow": "write products, or math.exp(y * math.log(x))",
        "hypot": "write math.sqrt(x * x + y * y)",
        "dist": "write math.sqrt(x * x + y * y)",
        "log2": "write math.log(x) / math.log(2.0)",
        "radians": "write x * (math.pi / 180.0)",
        "degrees": "write x * (180.0 / math.pi)",
    }.get(name, "use sin, cos, tan, exp, log, sqrt, floor, ceil or their like")
    return scope.refuse(node, f"math.{name} may round differently in compiled code", advice)


TABLE: dict[Any, Handler] = {
    getattr(math, name): _function(name) for name in (*CHECKED, *TESTS, *ROUNDED, *TWO, "fabs")
}
"""The functions by object."""
