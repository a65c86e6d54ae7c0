"""Arithmetic of integers, which have any size in Python and 64 bits in compiled code.

Where a result would not fit, compiled code raises ``OverflowError``, and the step is repeated in Python.
"""

from typing import TYPE_CHECKING

from qtab.compilation.rewriting.values import BOOL, FLOAT, INT, Value

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

CHECKED = {"+": "h_add", "-": "h_sub", "*": "h_mul", "//": "h_floordiv", "/": "h_truediv", "**": "h_ipow"}
CHECKED |= {"<<": "h_shl", ">>": "h_shr"}
"""The operators of two integers by the helpers that compute them."""


def arithmetic(scope: "Expressions", symbol: str, left: Value, right: Value) -> str | None:
    """Returns the code of an operator of two integers that raises an error outside 64 bits; None for others."""
    if {left.kind, right.kind} not in ({INT}, {INT, BOOL}) or symbol not in CHECKED:
        return None
    return called(scope, CHECKED[symbol], left, right)


def called(scope: "Expressions", helper: str, *values: Value) -> str:
    """Returns the code of a helper with integers or booleans as arguments."""
    scope.compiled.uses.add(helper)
    codes = [f"int({value.code})" if value.kind == BOOL else value.code for value in values]
    return f"{helper}({', '.join(codes)})"


def compared(scope: "Expressions", value: Value, other: Value) -> str:
    """Returns the code of an operand of a comparison: integers that no float holds exactly raise an error."""
    if value.kind == INT and other.kind == FLOAT and not (value.is_fixed and abs(value.fixed) <= 2**53):
        return called(scope, "h_exact", value)
    return value.code
