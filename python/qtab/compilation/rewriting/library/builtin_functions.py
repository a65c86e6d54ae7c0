"""Builtin functions."""

import ast
import builtins
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.rewriting.expressions import containers
from qtab.compilation.rewriting.library import Handler
from qtab.compilation.rewriting.program import as_float, tuple_value
from qtab.compilation.rewriting.statements.effects import constant_of
from qtab.compilation.rewriting.values import (
    BOOL,
    FLOAT,
    INT,
    MIXED,
    Array,
    DictKind,
    Scalar,
    TupleKind,
    Value,
    constant,
    in_words,
    join,
)

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

LAZY = (enumerate, filter, map, reversed, zip)
"""The functions that read their arguments when their results are read."""


def _one(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    if len(values) != 1 or named:
        raise scope.refuse(node, "this function with these arguments", "give one argument")
    return values[0]


def _convert(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value], made: Any) -> Value:
    value = _one(scope, node, values, named)
    if value.is_fixed and not isinstance(value.fixed, np.ndarray):
        return scope.folded(node, made, value.fixed)
    value = scope.lift(value, node)
    name = made.__name__
    if not isinstance(value.kind, Scalar):
        raise scope.refuse(node, f"{name} of {in_words(value.kind)}", "use an element of it")
    kind = {int: INT, float: FLOAT, bool: BOOL}[made]
    if made is int and value.kind == INT:
        return value
    code = as_float(value) if made is float else f"{name}({value.code})"
    if made is int and value.kind.name.startswith(("int", "uint")):  # they stay of their type in Numba
        code = f"int(np.int64({value.code}))"
    return Value(kind, code)


def _conversion(made: Any) -> Handler:
    return lambda scope, node, values, named: _convert(scope, node, values, named, made)


def _abs(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    value = _one(scope, node, values, named)
    if value.is_fixed:
        return scope.folded(node, abs, value.fixed)
    if value.kind in (INT, FLOAT, MIXED, Scalar("float32")):
        return Value(value.kind, f"abs({value.code})")
    if isinstance(value.kind, Array) and value.kind.dtype in ("int64", "float64", "float32"):
        return Value(value.kind, f"np.abs({value.code})", fresh=True)
    raise scope.refuse(node, f"abs of {in_words(value.kind)}", "use integers or floats")


def _extreme(function: Any) -> Handler:
    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if named:
            raise scope.refuse(node, "min or max with named arguments", "compare the numbers in a loop")
        if len(values) == 1:
            values = containers.elements(scope, node, values[0])
        if all(value.is_fixed for value in values):
            return scope.folded(node, function, [value.fixed for value in values])
        lifted = [scope.lift(value, node) for value in values]
        kind: Any = lifted[0].kind
        for value in lifted:
            kind = join(kind, value.kind) if value.kind in (INT, FLOAT, MIXED) else None
            if kind is None:
                advice = "convert them to int or float"
                raise scope.refuse(node, f"{function.__name__} with {in_words(value.kind)}", advice)
        # Integers that are compared with floats stay integers, so that those beyond 2**53 are found.
        return Value(kind, f"{function.__name__}({', '.join(one.code for one in lifted)})")

    return handler


def _len(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    value = _one(scope, node, values, named)
    if value.is_fixed:
        return scope.folded(node, len, value.fixed)
    if isinstance(value.kind, TupleKind | DictKind):
        scope.no_effects(value, node)
        return constant(len(value.kind.items))
    if isinstance(value.kind, Array):
        shape = value.kind.shape
        if shape is not None:
            scope.no_effects(value, node)
            return constant(shape[0])
        return Value(INT, f"{value.code}.shape[0]")
    raise scope.refuse(node, f"len of {in_words(value.kind)}", "use a tuple or an array")


def _sum(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    value = _one(scope, node, values, named)
    parts = containers.elements(scope, node, value)
    if all(part.is_fixed for part in parts):
        return scope.folded(node, sum, [part.fixed for part in parts])
    lifted = [scope.lift(part, node) for part in parts]
    wrong = next((part for part in lifted if part.kind not in (INT, BOOL)), None)
    if wrong is not None:
        floats = wrong.kind in (FLOAT, MIXED)
        advice = "add them with + or in a loop" if floats else "convert each: int(...)"
        raise scope.refuse(node, f"the sum of numbers, one of which is {in_words(wrong.kind)}", advice)
    total = " + ".join(f"int({part.code})" for part in lifted)
    return Value(INT, f"({total})")


def _any_or_all(symbol: str, empty: bool) -> Handler:
    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        value = _one(scope, node, values, named)
        codes = []
        parts = containers.elements(scope, node, value)
        if not isinstance(node.args[0], ast.GeneratorExp):  # Python evaluates all elements of others
            for part in parts[1:]:
                scope.no_effects(part, node, "a call that is left out if an element before it decides")
        for part in parts:
            if part.is_fixed:
                if bool(part.fixed) != empty:
                    codes.append(repr(not empty))
                    break
                continue
            if not isinstance(part.kind, Scalar):
                raise scope.refuse(node, f"the truth of {in_words(part.kind)}", "use booleans")
            codes.append(f"bool({part.code})")
        if not codes:
            return constant(empty)
        return Value(BOOL, "(" + f" {symbol} ".join(codes) + ")")

    return handler


def makes_iterator(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether an expression makes what can be read only once, such as ``zip(...)`` or a generator."""
    return isinstance(node, ast.GeneratorExp) or _called(scope, node) in LAZY


def _called(scope: "Expressions", node: ast.expr) -> Any:
    """Returns the builtin class that an expression calls; None for others."""
    found = constant_of(scope, node.func, scope.source.function, None) if isinstance(node, ast.Call) else None
    return found if isinstance(found, type) else None


def _sequence(made: Any) -> Handler:
    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if not values:
            return constant(made())
        value = _one(scope, node, values, named)
        if value.is_fixed and not isinstance(value.fixed, np.ndarray):
            return scope.folded(node, made, value.fixed)
        value = scope.lift(value, node)
        if isinstance(value.kind, Array):
            return containers.as_tuple(scope, node, value)
        if isinstance(value.kind, TupleKind):
            return containers.copied(value, _called(scope, node.args[0]) in (enumerate, zip))
        raise scope.refuse(node, f"{made.__name__} of {in_words(value.kind)}", "use tuples and arrays")

    return handler


def _dict(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    if values and not (len(values) == 1 and values[0].is_fixed and all(one.is_fixed for one in named.values())):
        raise scope.refuse(node, "dict with values that are known at run time", "write its keys and values in {...}")
    if all(one.is_fixed for one in named.values()):
        plain = {name: value.fixed for name, value in named.items()}
        return scope.folded(node, lambda *given: dict(*given, **plain), *[one.fixed for one in values])
    parts = tuple(scope.lift(one, node) for one in named.values())
    made = tuple_value(parts)
    return Value(DictKind(tuple(named), made.kind.items), made.code, parts=parts)


def _folded(function: Any) -> Handler:
    """Returns a handler for functions that are called with constants only."""

    def handler(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
        if all(value.is_fixed for value in (*values, *named.values())):
            plain = {name: value.fixed for name, value in named.items()}
            result = scope.folded(node, lambda *given: function(*given, **plain), *[value.fixed for value in values])
            return constant(list(result.fixed)) if function in LAZY else result
        if function in (enumerate, zip, reversed):
            return _lazy(scope, node, function, values)
        if function is range:
            raise scope.refuse(node, "range outside of a for loop", "write a for loop")
        name = function.__name__
        raise scope.refuse(node, f"{name} with values that are known at run time", "use numbers and comparisons")

    return handler


def _lazy(scope: "Expressions", node: ast.Call, function: Any, values: list[Value]) -> Value:
    many = [containers.elements(scope, node, value) for value in values[:1] + (values[1:] if function is zip else [])]
    if function is not enumerate:  # the elements change their order, or are left out
        for one in (one for row in many for one in row):
            scope.no_effects(one, node)
    views = frozenset[str]().union(*(value.views for value in values))
    if function is reversed:
        return replace(scope.tuple_of(many[0][::-1], node), views=views)
    rows = [[constant(i), one] for i, one in enumerate(many[0])] if function is enumerate else [
        list(row) for row in zip(*many, strict=False)
    ]  # fmt: skip
    lifted = [tuple_value(tuple(scope.lift(one, node) for one in row)) for row in rows]
    return replace(tuple_value(tuple(lifted)), views=views)


def _round(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    if all(value.is_fixed for value in (*values, *named.values())):
        return scope.folded(node, lambda *given: round(*given), *[one.fixed for one in (*values, *named.values())])
    if len(values) == 1 and not named and values[0].kind == INT:
        return values[0]
    if len(values) == 1 and not named and values[0].kind == FLOAT:
        return Value(INT, f"round({values[0].code})")
    raise scope.refuse(
        node, "round to digits may round differently", "leave out round, or round in units: round(x * 100)"
    )


def _divmod(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    if all(value.is_fixed for value in values) and not named:
        return scope.folded(node, divmod, *[value.fixed for value in values])
    lifted = [scope.lift(value, node) for value in values]
    if named or [value.kind for value in lifted] != [INT, INT]:
        raise scope.refuse(node, "divmod of something other than two integers", "write x // y and x % y")
    for value in lifted:
        scope.no_effects(value, node, "a call whose result is used several times")
    left, right = (value.code for value in lifted)
    return tuple_value((Value(INT, f"({left} // {right})"), Value(INT, f"({left} % {right})")))


def _isinstance(scope: "Expressions", node: ast.Call, values: list[Value], named: dict[str, Value]) -> Value:
    if len(values) == 2 and not named and values[0].is_fixed and values[1].is_fixed:
        return scope.folded(node, isinstance, values[0].fixed, values[1].fixed)
    if len(values) == 2 and values[1].is_fixed and values[0].kind == INT:
        kinds = values[1].fixed if isinstance(values[1].fixed, tuple) else (values[1].fixed,)
        if any(kind in (int, np.integer) for kind in kinds) and int in kinds and np.integer in kinds:
            scope.no_effects(values[0], node)
            return constant(True)
    raise scope.refuse(node, "the type of a value is tested", "convert it instead: int(...) or float(...)")


TABLE: dict[Any, Handler] = {
    int: _conversion(int),
    float: _conversion(float),
    bool: _conversion(bool),
    abs: _abs,
    min: _extreme(min),
    max: _extreme(max),
    len: _len,
    sum: _sum,
    any: _any_or_all("or", False),
    all: _any_or_all("and", True),
    tuple: _sequence(tuple),
    list: _sequence(list),
    round: _round,
    isinstance: _isinstance,
    divmod: _divmod,
    dict: _dict,
    **{getattr(builtins, name): _folded(getattr(builtins, name)) for name in
       ("enumerate", "zip", "reversed", "range", "sorted", "set", "frozenset", "pow", "str", "repr",
        "getattr", "hasattr", "type", "map", "filter")},
}  # fmt: skip
"""The functions by object."""
