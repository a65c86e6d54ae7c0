"""The kinds of arithmetic and comparisons, where compiled code computes what Python computes."""

import ast
import operator
from typing import Any, TypeAlias

import numpy as np

from qtab.compilation.rewriting.values import (
    BOOL,
    FLOAT,
    INT,
    MIXED,
    REAL,
    WIDE,
    Array,
    Kind,
    Scalar,
    TupleKind,
    Value,
    dtype_of,
    in_words,
    scalar_of,
)

SYMBOLS: dict[type, tuple[str, Any]] = {
    ast.Add: ("+", operator.add),
    ast.Sub: ("-", operator.sub),
    ast.Mult: ("*", operator.mul),
    ast.Div: ("/", operator.truediv),
    ast.FloorDiv: ("//", operator.floordiv),
    ast.Mod: ("%", operator.mod),
    ast.Pow: ("**", operator.pow),
    ast.BitAnd: ("&", operator.and_),
    ast.BitOr: ("|", operator.or_),
    ast.BitXor: ("^", operator.xor),
    ast.LShift: ("<<", operator.lshift),
    ast.RShift: (">>", operator.rshift),
}
COMPARISONS: dict[type, tuple[str, Any]] = {
    ast.Eq: ("==", operator.eq),
    ast.NotEq: ("!=", operator.ne),
    ast.Lt: ("<", operator.lt),
    ast.LtE: ("<=", operator.le),
    ast.Gt: (">", operator.gt),
    ast.GtE: (">=", operator.ge),
}
Result: TypeAlias = Any
"""A kind; or a reason and an advice, if compiled code would not compute the same as Python."""


def binary(symbol: str, left: Value, right: Value) -> Result:
    """Returns the kind of a result, or why compiled code would not compute it as Python does."""
    one, other = left.kind, right.kind
    if isinstance(one, TupleKind) and isinstance(other, TupleKind) and symbol == "+":
        return TupleKind(one.items + other.items)
    if isinstance(one, Scalar) and isinstance(other, Scalar):
        return _scalars(symbol, left, right)
    if isinstance(one, Scalar | Array) and isinstance(other, Scalar | Array):
        return _arrays(symbol, left, right)
    advice = "compute with numbers and NumPy arrays"
    return f"{in_words(one)} {symbol} {in_words(other)}", advice


def _scalars(symbol: str, left: Value, right: Value) -> Result:
    one, other = left.kind, right.kind
    if one not in WIDE or other not in WIDE:
        if one == other == Scalar("float32") and symbol in "+-*/":
            return one
        narrow = one if one not in WIDE else other
        convert = "float" if "float" in narrow.name else "int"
        return (
            f"{in_words(narrow)} in arithmetic, which has another type in compiled code",
            f"convert it: {convert}(...)",
        )
    if symbol in ("&", "|", "^", "<<", ">>"):
        if one == other == BOOL and symbol in "&|^":
            return BOOL
        if {one, other} <= {INT, BOOL}:
            return INT
        return f"{in_words(one)} {symbol} {in_words(other)}", "use integers"
    if one == other == BOOL:
        return "arithmetic with two booleans", "convert them: int(...)"
    if symbol == "**":
        return _power(left, right)
    if MIXED in (one, other) and symbol in ("*", "/", "//", "%"):
        which = "a number that is sometimes an integer: the sign of a zero would differ"
        return which, "write a float in every assignment, such as 0.0 for 0"
    if symbol == "/":
        return FLOAT
    kinds = {one, other} - {BOOL}
    return INT if kinds == {INT} else FLOAT if FLOAT in kinds else MIXED


def _power(left: Value, right: Value) -> Result:
    exponent = right.fixed if right.is_fixed else None
    if left.kind == INT and isinstance(exponent, int) and exponent >= 0:
        return INT
    if exponent == 2:
        return "a float to a power: compiled code would round differently", "write x * x"
    if exponent == 0.5:
        return "a float to a power: compiled code would round differently", "write math.sqrt(x)"
    return "a power: compiled code would round differently", "write products, or math.exp(y * math.log(x))"


def _arrays(symbol: str, left: Value, right: Value) -> Result:
    one, other = left.kind, right.kind
    dtypes = [kind.dtype if isinstance(kind, Array) else dtype_of(kind) for kind in (one, other)]
    shape = broadcast(one, other)
    ndim = max(kind.ndim for kind in (one, other) if isinstance(kind, Array))
    if set(dtypes) == {"float32"} and symbol in "+-*/":
        return Array("float32", ndim, shape)
    if not set(dtypes) <= {"int64", "float64", "bool"} or MIXED in (one, other):
        return (
            f"{dtypes[0]} {symbol} {dtypes[1]}, which has another type in compiled code",
            "convert with .astype first",
        )
    if symbol in "&|^":
        same = set(dtypes) == {"bool"}
        return Array("bool", ndim, shape) if same else ("bits of arrays", "use arrays of booleans")
    if set(dtypes) == {"bool"} or symbol not in "+-*/":
        if symbol in ("//", "%") and "float64" not in dtypes and right.is_fixed and np.all(right.fixed > 0):
            return Array("int64", ndim, shape)
        return f"{symbol} with arrays", "write a loop over the elements"
    return Array("float64" if symbol == "/" or "float64" in dtypes else "int64", ndim, shape)


def broadcast(one: Kind, other: Kind) -> tuple[int, ...] | None:
    """Returns the shape of an elementwise result; None if it is not known."""
    shapes = [kind.shape if isinstance(kind, Array) else () for kind in (one, other)]
    if shapes[0] is None or shapes[1] is None:
        return None
    try:
        return np.broadcast_shapes(shapes[0], shapes[1])
    except ValueError:
        return None


def unary(symbol: str, value: Value) -> Result:
    """Returns the kind of ``-x``, ``+x`` or ``~x``, or why it cannot be compiled."""
    kind = value.kind
    if kind == MIXED:
        reason = "a number that is sometimes an integer: the sign of a zero would differ"
        return reason, "write a float in every assignment, such as 0.0 for 0"
    if symbol in "+-" and kind in (*REAL, Scalar("float32")):
        return kind
    if symbol in "+-" and isinstance(kind, Array) and kind.dtype in ("int64", "float64", "float32"):
        return kind
    if symbol == "~" and (kind == INT or (isinstance(kind, Array) and kind.dtype in ("int64", "bool"))):
        return kind
    return f"{symbol} of {in_words(kind)}", "use integers or floats (and `not` for booleans)"


def comparison(symbol: str, left: Value, right: Value) -> Result:
    """Returns the kind of a comparison, or why it cannot be compiled."""
    one, other = left.kind, right.kind
    if isinstance(one, TupleKind) and isinstance(other, TupleKind):
        simple = all(item in WIDE for item in one.items + other.items)
        if len(one.items) == len(other.items) and symbol in ("==", "!=") and simple:
            return BOOL
        return f"{in_words(one)} {symbol} {in_words(other)}", "compare the elements"
    if isinstance(one, Scalar | Array) and isinstance(other, Scalar | Array):
        if not _comparable(left, right):
            return f"{in_words(one)} {symbol} {in_words(other)}", "convert both to float or int first"
        if isinstance(one, Scalar) and isinstance(other, Scalar):
            return BOOL
        ndim = max(kind.ndim for kind in (one, other) if isinstance(kind, Array))
        return Array("bool", ndim, broadcast(one, other))
    return f"{in_words(one)} {symbol} {in_words(other)}", "compare numbers"


def _comparable(left: Value, right: Value) -> bool:
    names = []
    for value in (left, right):
        kind = scalar_of(value.kind.dtype) if isinstance(value.kind, Array) else value.kind
        if kind.name == "float32" or (kind == FLOAT and value.is_fixed and isinstance(value.fixed, float)):
            exact = (
                value.is_fixed
                and not isinstance(value.fixed, np.ndarray)
                and float(np.float32(value.fixed)) == value.fixed
            )
            names.append("any" if exact else kind.name)
        elif kind == INT and value.is_fixed and not isinstance(value.fixed, np.ndarray) and abs(value.fixed) < 128:
            names.append("any" if value.fixed >= 0 else "signed")
        else:
            names.append(kind.name)
    kinds = set(names) - {"any"}
    if "float32" in kinds:
        return kinds <= {"float32", "signed"}
    if any(name.startswith("uint") for name in kinds):
        return len(kinds) == 1
    return True
