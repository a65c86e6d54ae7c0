"""Functions of NumPy that make arrays, and ``np.array_equal``."""

import ast
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.rewriting.library import Handler, arguments, arrays
from qtab.compilation.rewriting.values import BOOL, WIDE, Array, TupleKind, Value, in_words, numpy_type

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions


def array(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    """``np.array``: a new array."""
    value, dtype = arguments(scope, node, ("object", "dtype"), values, named)
    name = None if dtype.fixed is None else arrays.dtype_name(scope, node, dtype)
    return arrays.make(scope, node, value, name)


def asarray(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    """``np.asarray``: a new array in compiled code, but the same one in Python unless its dtype differs."""
    made = array(scope, node, values, named)
    given = values[0] if values else named.get("object", made)
    return replace(made, views=given.views, fresh=given.fresh) if made.kind == given.kind else made


def filled(function: str) -> Handler:
    """Returns the handler of ``np.zeros``, ``np.ones`` or ``np.full``."""

    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        names = ("shape", "fill_value", "dtype") if function == "full" else ("shape", "dtype")
        given = dict(zip(names, arguments(scope, node, names, values, named), strict=True))
        shape, dtype = given["shape"].fixed, given["dtype"]
        shape = tuple(int(one) for one in shape) if isinstance(shape, tuple | list) else shape
        sizes = (int(shape),) if isinstance(shape, int | np.integer) else shape
        if not isinstance(sizes, tuple):
            raise scope.refuse(node, f"np.{function} with a shape that is known at run time", "use a constant shape")
        fill = scope.lift(given["fill_value"], node) if function == "full" else None
        if fill is not None and fill.kind not in WIDE:
            raise scope.refuse(node, f"np.full with {in_words(fill.kind)}", "fill it with a number")
        if dtype.is_fixed and dtype.fixed is None:
            name = "float64" if fill is None else arrays.result_dtype(scope, node, [fill.kind])
        else:
            name = arrays.dtype_name(scope, node, dtype)
        if fill is None:
            code = f"np.{function}({sizes}, {numpy_type(name)})"
        elif name == "bool" and fill.kind != BOOL:
            code = f"np.full({sizes}, bool({fill.code}), np.bool_)"
        else:
            code = f"np.full({sizes}, {fill.code}, {numpy_type(name)})"
        return Value(Array(name, len(sizes), sizes), code, fresh=True)

    return handler


def like(function: str) -> Handler:
    """Returns the handler of ``np.copy``, ``np.zeros_like`` or ``np.ones_like``."""

    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        (value,) = arguments(scope, node, ("a",), values, named)
        value = scope.lift(value, node)
        if not isinstance(value.kind, Array):
            raise scope.refuse(node, f"np.{function} of {in_words(value.kind)}", "give an array")
        return Value(value.kind, f"np.{function}({value.code})", fresh=True)

    return handler


def concatenate(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    """``np.concatenate`` of vectors."""
    parts = values[0].parts if len(values) == 1 and not named else None
    if parts is None:
        raise scope.refuse(node, "np.concatenate with these arguments", "give a list of vectors")
    made = [arrays.make(scope, node, one, None) if isinstance(one.kind, TupleKind) else one for one in parts]
    kinds = [one.kind for one in made]
    if not all(isinstance(kind, Array) and kind.ndim == 1 and kind.dtype == kinds[0].dtype for kind in kinds):
        raise scope.refuse(node, "np.concatenate of several dtypes or dimensions", "convert with .astype first")
    sizes: list[Any] = [kind.shape[0] if kind.shape else None for kind in kinds]
    shape = None if None in sizes else (sum(map(int, sizes)),)
    code = f"np.concatenate(({', '.join(one.code for one in made)},))"
    return Value(Array(kinds[0].dtype, 1, shape), code, fresh=True)


def array_equal(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    """``np.array_equal`` of two arrays."""
    if len(values) != 2 or named:
        raise scope.refuse(node, "np.array_equal with these arguments", "give two arrays")
    one, other = (
        arrays.make(scope, node, value, None) if isinstance(value.kind, TupleKind) else value
        for value in (scope.lift(value, node) for value in values)
    )
    if not isinstance(one.kind, Array) or not isinstance(other.kind, Array):
        raise scope.refuse(node, "np.array_equal of numbers", "write ==")
    if one.kind.ndim != other.kind.ndim or one.kind.dtype != other.kind.dtype:
        raise scope.refuse(node, "np.array_equal of arrays of two dtypes or dimensions", "convert with .astype first")
    helper = "h_equal_vectors" if one.kind.ndim == 1 else "h_equal"
    scope.compiled.uses.add(helper)
    return Value(BOOL, f"bool({helper}({one.code}, {other.code}))")
