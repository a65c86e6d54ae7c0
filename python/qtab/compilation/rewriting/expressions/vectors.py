"""Arithmetic and comparisons of vectors as loops, which compile faster than Numba's functions of arrays."""

from typing import TYPE_CHECKING, Any

from qtab.compilation.rewriting.values import FLOAT, INT, Array, Value, numpy_type

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

NAMES = {"+": "add", "-": "subtract", "*": "multiply", "==": "equal", "!=": "not_equal"}
NAMES |= {"<": "less", "<=": "less_equal", ">": "greater", ">=": "greater_equal"}
"""The operators whose elements are computed as NumPy does, by the names of their functions."""


def code(scope: "Expressions", symbol: str, left: Value, right: Value, kind: Any) -> str | None:
    """Returns the code of an operator with one or two vectors; None for others.

    Args:
        scope: The function that is rewritten.
        symbol: The operator.
        left: The left operand.
        right: The right operand.
        kind: The kind of the result.
    """
    forms = _form(left.kind), _form(right.kind)
    if symbol not in NAMES or "" in forms or not isinstance(kind, Array) or kind.ndim != 1:
        return None
    if forms == ("v", "v") and (left.kind.shape is None or left.kind.shape != right.kind.shape):
        return None
    name = f"h_{NAMES[symbol]}_{kind.dtype}_{''.join(forms)}"
    if name not in scope.program.named:
        items = ["a[i]" if forms[0] == "v" else "a", "b[i]" if forms[1] == "v" else "b"]
        size = "a" if forms[0] == "v" else "b"
        lines = [
            f"def {name}(a, b):",
            f"    made = np.empty({size}.shape[0], {numpy_type(kind.dtype)})",
            f"    for i in range({size}.shape[0]):",
            f"        made[i] = {items[0]} {symbol} {items[1]}",
            "    return made",
        ]
        scope.program.add(name, lines)
    scope.compiled.uses.add(name)
    return f"{name}({left.code}, {right.code})"


def _form(kind: Any) -> str:
    """Returns ``v`` for a vector and ``s`` for a number of 64 bits; empty for others."""
    if isinstance(kind, Array):
        return "v" if kind.ndim == 1 and kind.dtype in ("int64", "float64") else ""
    return "s" if kind in (INT, FLOAT) else ""
