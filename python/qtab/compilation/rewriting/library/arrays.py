"""Methods of arrays, and the reductions that round as NumPy's."""

import ast
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.rewriting.expressions import containers
from qtab.compilation.rewriting.program import converted
from qtab.compilation.rewriting.values import (
    BOOL,
    INT,
    Array,
    Scalar,
    TupleKind,
    Value,
    constant,
    in_words,
    numpy_type,
    scalar_of,
)

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

REDUCTIONS = ("sum", "min", "max", "any", "all", "argmax", "argmin")


def method(scope: "Expressions", node: ast.Call, name: str, base: Value) -> Value:
    """Returns the value of ``array.name(...)``."""
    values, named = scope.arguments(node)
    if isinstance(node.func, ast.Attribute):
        base = scope.lift(base, node.func.value)
    kind = base.kind
    if name == "copy" and not values and not named:
        return copied(base)
    if name == "astype" and len(values) == 1 and not named:
        return cast(scope, node, base, values[0])
    if name in ("flatten", "ravel") and not values and not named:
        size = None if kind.shape is None else (int(np.prod(kind.shape)),)
        made = Value(Array(kind.dtype, 1, size), f"{base.code}.flatten()", fresh=True)
        return replace(made, views=base.views, fresh=base.fresh) if name == "ravel" else made  # which may return a view
    if name in ("tolist", "item") and not values and kind.dtype not in ("bool", "int64", "float64"):
        wide = "np.float64" if "float" in kind.dtype else "np.int64"
        raise scope.refuse(node, f"the method {name} of an array of {kind.dtype}", f"write .astype({wide}).{name}()")
    if name == "tolist" and kind.ndim == 1 and not values:
        return containers.as_tuple(scope, node, base)
    if name == "item" and not values and kind.shape is not None and np.prod(kind.shape) == 1:
        scalar = scalar_of(kind.dtype)
        index = ", ".join(["0"] * kind.ndim)
        return Value(scalar, converted(f"{base.code}[{index}]", scalar))
    if name == "fill":
        raise scope.refuse(node, "the method fill of an array", "write array[:] = value")
    if name in REDUCTIONS and not values and not named:
        return reduced(scope, node, name, base)
    what = "with these arguments" if name in REDUCTIONS else "of an array"
    raise scope.refuse(node, f"the method {name} {what}", "write a loop over the elements")


def copied(value: Value) -> Value:
    """Returns a new array with the same elements."""
    code = value.code if value.code.endswith(".copy()") or value.raw else f"{value.code}.copy()"
    return Value(value.kind, code, fresh=True)


def dtype_name(scope: "Expressions", node: ast.AST, value: Value) -> str:
    """Returns the name of a dtype that is given as an argument."""
    if not value.is_fixed:
        raise scope.refuse(node, "a dtype that is known at run time", "write the dtype")
    try:
        dtype = np.dtype(value.fixed)
    except TypeError:
        raise scope.refuse(node, "an unknown dtype", "write np.float32, np.float64 or np.int64") from None
    name: str = dtype.name
    if dtype.kind not in "biuf" or dtype.itemsize > 8 or name == "float16":
        raise scope.refuse(node, f"the dtype {name}", "write np.float32, np.float64 or np.int64")
    return name


def cast(scope: "Expressions", node: ast.AST, value: Value, dtype: Value) -> Value:
    """Returns an array with another dtype."""
    name = dtype_name(scope, node, dtype)
    kind = value.kind
    if name == "bool":
        return Value(Array("bool", kind.ndim, kind.shape), f"({value.code} != 0)", fresh=True)
    if kind.dtype.startswith("float") and not name.startswith(("float", "int64")):
        raise scope.refuse(node, f"{kind.dtype} converted to {name}", "convert to np.int64 first")
    return Value(Array(name, kind.ndim, kind.shape), f"{value.code}.astype({numpy_type(name)})", fresh=True)


def reduced(scope: "Expressions", node: ast.AST, name: str, value: Value) -> Value:
    """Returns the sum, minimum or the like of an array."""
    kind = value.kind
    scalar = scalar_of(kind.dtype)
    code = value.code
    if name in ("any", "all"):
        test = code if kind.dtype == "bool" else f"({code} != 0)"
        return Value(BOOL, f"bool(np.{name}({test}))")
    if name == "sum":
        if scalar not in (INT, BOOL):
            raise scope.refuse(node, f"the sum of {in_words(kind)} may round differently", "add the elements in a loop")
        return Value(INT, f"int(np.sum({code}))")
    if name in ("min", "max") and scalar == INT:
        return Value(INT, converted(f"np.{name}({code})", INT))
    if name in ("argmax", "argmin") and kind.ndim == 1 and scalar in (INT, BOOL):
        scope.compiled.uses.add(f"h_{name}")
        return Value(INT, f"h_{name}({code})")
    raise scope.refuse(node, f"{name} of {in_words(kind)}", "write a loop over the elements")


def make(scope: "Expressions", node: ast.AST, value: Value, dtype: str | None) -> Value:
    """Returns ``np.array(value, dtype)``: a new array."""
    if isinstance(value.fixed, np.ndarray) or isinstance(value.kind, Array):
        value = scope.lift(value, node)
        if dtype is None or dtype == value.kind.dtype:
            return copied(value)
        return cast(scope, node, value, constant(dtype))
    value = scope.lift(value, node)
    if not isinstance(value.kind, TupleKind) or not value.kind.items:
        raise scope.refuse(node, f"np.array of {in_words(value.kind)}", "give a list of numbers")
    rows = value.kind.items
    if all(isinstance(one, TupleKind) for one in rows):
        return _matrix(scope, node, value, dtype)
    if not all(isinstance(one, Scalar) for one in rows):
        raise scope.refuse(node, "np.array of several arrays", "write np.concatenate, or assign the parts to np.zeros")
    return _vector(scope, node, value, dtype)


def result_dtype(scope: "Expressions", node: ast.AST, kinds: list[Any]) -> str:
    """Returns the dtype that NumPy gives to an array of such numbers."""
    names = {kind.name for kind in kinds}
    if names <= {"int", "float", "mixed", "bool"}:
        if "mixed" in names and "float" not in names:
            reason = "an array of numbers that are sometimes integers and sometimes floats, without dtype"
            raise scope.refuse(node, reason, "give a dtype, such as np.float32")
        return "float64" if "float" in names else "int64" if "int" in names else "bool"
    if len(names) == 1:
        return str(names.pop())
    raise scope.refuse(node, "an array of numbers of several dtypes", "give a dtype, such as np.float32")


def _vector(scope: "Expressions", node: ast.AST, value: Value, dtype: str | None) -> Value:
    kinds = list(value.kind.items)
    name = dtype or result_dtype(scope, node, kinds)
    kind = Array(name, 1, (len(kinds),))
    _check_conversion(scope, node, kinds, name)
    function = _maker(scope, kinds, name)
    codes = [part.code for part in value.parts] if value.parts is not None else [f"*{value.code}"]
    return Value(kind, f"{function}({', '.join(codes)})", fresh=True)


def _check_conversion(scope: "Expressions", node: ast.AST, kinds: list[Any], name: str) -> None:
    small = name.startswith(("int", "uint")) and name != "int64"
    if (small or name == "bool") and any("float" in kind.name or kind.name == "mixed" for kind in kinds):
        raise scope.refuse(node, f"floats converted to {name}", "write int(...)")


def _maker(scope: "Expressions", kinds: list[Any], dtype: str) -> str:
    """Returns the name of a function that makes a vector of its arguments."""
    name = f"f_vector_{dtype}_{len(kinds)}"
    if name not in scope.program.named:
        names = [f"a{i}" for i in range(len(kinds))]
        lines = [f"def {name}({', '.join(names)}):", f"    made = np.empty({len(kinds)}, {numpy_type(dtype)})"]
        lines += [f"    made[{i}] = {one}" for i, one in enumerate(names)]
        scope.program.add(name, [*lines, "    return made"])
    scope.compiled.uses.add(name)
    return name


def _matrix(scope: "Expressions", node: ast.AST, value: Value, dtype: str | None) -> Value:
    rows = value.kind.items
    width = len(rows[0].items)
    kinds = [one for row in rows for one in row.items]
    if any(len(row.items) != width for row in rows) or not all(isinstance(one, Scalar) for one in kinds):
        raise scope.refuse(node, "np.array of lists of different lengths", "use rows of one length")
    name = dtype or result_dtype(scope, node, kinds)
    _check_conversion(scope, node, kinds, name)
    for row in [scope.element(value, i) for i in range(len(rows))] if width != 1 else []:
        if row.parts is None:
            scope.no_effects(row, node, "a call whose result is used several times")
    flat = [scope.element(scope.element(value, i), j).code for i in range(len(rows)) for j in range(width)]
    code = f"{_maker(scope, kinds, name)}({', '.join(flat)}).reshape({len(rows)}, {width})"
    return Value(Array(name, 2, (len(rows), width)), code, fresh=True)
