"""Functions of NumPy that compiled code computes to the same bits."""

import ast
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.checks.known_functions import NUMPY_DIFFERENT
from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.expressions.operators import broadcast
from qtab.compilation.rewriting.library import Handler, arguments, arrays, numpy_arrays
from qtab.compilation.rewriting.values import (
    BOOL,
    FLOAT,
    INT,
    MIXED,
    REAL,
    Array,
    Kind,
    Scalar,
    TupleKind,
    Value,
    dtype_of,
    in_words,
)

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

ADVICE = {
    **NUMPY_DIFFERENT,
    "norm": "write math.sqrt of the sum of products",
    "mean": "add the elements in a loop, and divide",
    **dict.fromkeys(("dot", "matmul"), "write the sums as a loop"),
    "append": "use an array of fixed size, with a counter",
    "where": "write an if, or a loop over the elements",
    "ravel_multi_index": "write row * columns + column",
    "unravel_index": "write index // columns and index % columns",
}
"""What to write instead of functions that are not in ``TABLE``."""


def refused(scope: "Expressions", node: ast.AST, function: Any, module: str) -> NotCompilable:
    """Returns the error for another function of NumPy."""
    name = str(getattr(function, "__name__", function))
    if "random" in module:
        return scope.refuse(node, "random numbers outside self.np_random", "draw from self.np_random")
    differs = name in NUMPY_DIFFERENT
    reason = (
        f"np.{name} {'rounds differently in compiled code' if differs else 'cannot be compiled with the same result'}"
    )
    return scope.refuse(node, reason, ADVICE.get(name, "write it with a loop over the elements"))


def _clip(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    given = arguments(scope, node, ("a", "a_min", "a_max"), values, named)
    if any(value.is_fixed and value.fixed is None for value in given):
        raise scope.refuse(node, "np.clip without both bounds", "write min(...) or max(...)")
    value, low, high = (scope.lift(one, node) for one in given)
    kinds = [one.kind for one in (value, low, high)]
    if all(kind in REAL for kind in kinds):
        joined = INT if set(kinds) == {INT} else FLOAT
        codes = [one.code if joined == INT else f"float({one.code})" for one in (value, low, high)]
        scope.compiled.uses.add("h_clip")
        return Value(joined, f"h_clip({', '.join(codes)})")
    if isinstance(kinds[0], Array):
        return _clip_array(scope, node, value, low, high)
    shown = ", ".join(in_words(kind) for kind in kinds)
    raise scope.refuse(node, f"np.clip with {shown}", "convert the bounds with float(...) or int(...)")


def _clip_array(scope: "Expressions", node: ast.AST, value: Value, low: Value, high: Value) -> Value:
    dtype = value.kind.dtype
    bounds = []
    for one in (low, high):
        if isinstance(one.kind, TupleKind):
            one = arrays.make(scope, node, one, None)
        if isinstance(one.kind, Array):
            if one.kind.dtype != dtype or one.kind.shape is None or one.kind.shape != value.kind.shape:
                advice = f"give bounds of dtype {dtype} and of the same shape"
                raise scope.refuse(node, f"np.clip of {in_words(value.kind)} with {in_words(one.kind)}", advice)
            bounds.append(one)
        elif (dtype, one.kind) in (("int64", INT), ("float64", INT), ("float64", FLOAT), ("float64", MIXED)):
            bounds.append(one if dtype == "int64" else Value(FLOAT, f"float({one.code})"))
        else:
            advice = f"give bounds of dtype {dtype}"
            raise scope.refuse(node, f"np.clip of {in_words(value.kind)} with {in_words(one.kind)}", advice)
    both = [isinstance(one.kind, Array) for one in bounds]
    if both[0] != both[1]:
        raise scope.refuse(node, "np.clip with a number and an array as bounds", "give two numbers or two arrays")
    names = ("h_clip_vector", "h_clip_vectors") if value.kind.ndim == 1 else ("h_clip_array", "h_clip_arrays")
    name = names[both[0]]
    scope.compiled.uses.add(name)
    code = f"{name}({value.code}, {bounds[0].code}, {bounds[1].code})"
    return Value(value.kind, code, fresh=True)


def _elementwise(name: str, kinds: tuple[Kind, ...], dtypes: tuple[str, ...], scalar: str) -> Handler:
    """Returns the handler of a function of one argument whose result is rounded exactly.

    Args:
        name: The function.
        kinds: The numbers that it takes.
        dtypes: The arrays that it takes.
        scalar: Its code for a number ``{}``.
    """

    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if len(values) != 1 or named:
            raise scope.refuse(node, f"np.{name} with these arguments", "give one argument")
        if values[0].is_fixed and not isinstance(values[0].fixed, np.ndarray):
            return scope.folded(node, getattr(np, name), values[0].fixed)
        value = scope.lift(values[0], node)
        if isinstance(value.kind, Array) and value.kind.dtype in dtypes:
            return Value(value.kind, f"np.{name}({value.code})", fresh=True)
        if value.kind in kinds:
            kind = value.kind if "float" not in scalar else FLOAT
            return Value(kind, scalar.format(value.code))
        raise scope.refuse(node, f"np.{name} of {in_words(value.kind)}", "use integers or floats of 64 bits")

    return handler


def _extreme(name: str) -> Handler:
    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if len(values) != 2 or named:
            raise scope.refuse(node, f"np.{name} with these arguments", "give two arguments")
        one, other = (scope.lift(value, node) for value in values)
        if one.kind == other.kind == INT:
            function = name.removesuffix("imum")
            return Value(INT, f"{function}({one.code}, {other.code})")
        kinds = [kind.dtype if isinstance(kind, Array) else dtype_of(kind) for kind in (one.kind, other.kind)
                 if isinstance(kind, Array | Scalar)]  # fmt: skip
        if set(kinds) == {"int64"} and len(kinds) == 2:
            ndim = max(kind.ndim for kind in (one.kind, other.kind) if isinstance(kind, Array))
            kind = Array("int64", ndim, broadcast(one.kind, other.kind))
            return Value(kind, f"np.{name}({one.code}, {other.code})", fresh=True)
        raise scope.refuse(node, f"np.{name} of floats: zeros may differ in sign", f"write {name[:3]}(x, y) or np.clip")

    return handler


def _reduction(name: str) -> Handler:
    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if len(values) != 1 or named:
            raise scope.refuse(node, f"np.{name} with these arguments", "write a loop over the elements")
        value = scope.lift(values[0], node)
        if isinstance(value.kind, TupleKind):
            value = arrays.make(scope, node, value, None)
        if not isinstance(value.kind, Array):
            raise scope.refuse(node, f"np.{name} of {in_words(value.kind)}", "give an array")
        return arrays.reduced(scope, node, name, value)

    return handler


def _cast(name: str) -> Handler:
    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if len(values) != 1 or named:
            raise scope.refuse(node, f"np.{name} with these arguments", "give one number")
        value = values[0]
        if isinstance(value.kind, TupleKind | Array) or isinstance(value.fixed, list | tuple | np.ndarray):
            return arrays.make(scope, node, value, "bool" if name == "bool_" else name)
        if value.is_fixed:
            return scope.folded(node, getattr(np, name), value.fixed)
        if not isinstance(value.kind, Scalar) or (not name.startswith("float") and value.kind not in (INT, BOOL)):
            raise scope.refuse(node, f"np.{name} of {in_words(value.kind)}", "write int(...) first")
        kind = {"int64": INT, "float64": FLOAT, "bool_": BOOL}.get(name, Scalar(name))
        return Value(kind, f"np.{name}({value.code})")

    return handler


REFUSED: tuple[Any, ...] = (np.random.default_rng,)
TABLE: dict[Any, Handler] = {
    np.clip: _clip,
    np.array: numpy_arrays.array,
    np.asarray: numpy_arrays.asarray,
    np.copy: numpy_arrays.like("copy"),
    np.zeros: numpy_arrays.filled("zeros"),
    np.ones: numpy_arrays.filled("ones"),
    np.full: numpy_arrays.filled("full"),
    np.zeros_like: numpy_arrays.like("zeros_like"),
    np.ones_like: numpy_arrays.like("ones_like"),
    np.sin: _elementwise("sin", REAL, ("float64",), "np.sin(float({}))"),
    np.cos: _elementwise("cos", REAL, ("float64",), "np.cos(float({}))"),
    np.sqrt: _elementwise("sqrt", REAL, ("float64",), "np.sqrt(float({}))"),
    np.abs: _elementwise("abs", (INT, FLOAT, MIXED), ("int64", "float64", "float32"), "abs({})"),
    np.fabs: _elementwise("fabs", REAL, ("float64",), "abs(float({}))"),
    np.floor: _elementwise("floor", REAL, ("float64",), "np.floor(float({}))"),
    np.ceil: _elementwise("ceil", REAL, ("float64",), "np.ceil(float({}))"),
    np.square: _elementwise("square", (), ("float64", "int64"), "{}"),
    np.minimum: _extreme("minimum"),
    np.maximum: _extreme("maximum"),
    **{getattr(np, name): _reduction(name) for name in ("sum", "min", "max", "any", "all", "argmax", "argmin")},
    np.array_equal: numpy_arrays.array_equal,
    np.concatenate: numpy_arrays.concatenate,
    **{getattr(np, name): _cast(name) for name in
       ("int64", "float64", "float32", "int32", "int16", "int8", "uint8", "bool_")},
}  # fmt: skip
"""The functions by object."""
