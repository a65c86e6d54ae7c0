"""Elements of constants, tuples and arrays."""

import ast
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.program import converted, tuple_value
from qtab.compilation.rewriting.values import (
    BOOL,
    INT,
    Array,
    DictKind,
    InfoKind,
    Scalar,
    TupleKind,
    Value,
    constant,
    in_words,
    join,
    scalar_of,
)

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

MAX_CASES = 256
"""The most keys of a dict, or elements of a set, that become comparisons."""


def unpacked(scope: "Expressions", nodes: list[ast.expr]) -> list[Value]:
    """Returns the values of the elements of a tuple or of the arguments of a call; ``*values`` is unpacked."""
    values: list[Value] = []
    for node in nodes:
        if isinstance(node, ast.Starred):
            values += elements(scope, node, scope.expression(node.value))
        else:
            values.append(scope.expression(node))
    return values


def subscript(scope: "Expressions", node: ast.Subscript) -> Value:
    """Returns the value of ``base[index]``."""
    base = scope.expression(node.value)
    if isinstance(base.kind, InfoKind):
        raise scope.refuse(node, "the info dict is read", "keep the number in an attribute of the environment")
    if specials.is_special(base.fixed):
        raise specials.refused_special(scope, node, base)
    if isinstance(base.kind, Array) or isinstance(base.fixed, np.ndarray):
        return element(scope, node, base)
    key = index_value(scope, node.slice)
    if base.is_fixed:
        if key.is_fixed:
            return scope.folded(node, lambda one, two: one[two], base.fixed, key.fixed)
        return lookup(scope, node, base.fixed, scope.lift(key, node))
    if isinstance(base.kind, DictKind | TupleKind) and key.is_fixed:
        keys = base.kind.keys if isinstance(base.kind, DictKind) else range(len(base.kind.items))
        if isinstance(base.kind, TupleKind) and isinstance(key.fixed, slice):
            for one in base.parts or (base,):
                scope.no_effects(one, node)
            chosen = keys[key.fixed]
            return tuple_value(tuple(scope.element(base, i) for i in chosen))
        try:
            position = keys.index(key.fixed) if isinstance(base.kind, DictKind) else keys[key.fixed]
        except (ValueError, IndexError, TypeError):
            raise scope.refuse(node, f"there is no element {key.fixed!r}", "correct the index") from None
        for i, one in enumerate(base.parts or ()):
            if i != position % len(keys):
                scope.no_effects(one, node)
        return scope.element(base, position)
    if isinstance(base.kind, TupleKind) and key.kind == INT and len(set(base.kind.items)) == 1:
        views = frozenset[str]() if isinstance(base.kind.items[0], Scalar) else base.views
        return Value(base.kind.items[0], f"{base.code}[{key.code}]", views=views)
    raise scope.refuse(node, f"an element of {in_words(base.kind)}", "use a NumPy array indexed by integers")


def index_value(scope: "Expressions", node: ast.expr) -> Value:
    """Returns an index: a constant, or code."""
    if isinstance(node, ast.Slice):
        parts = [None if one is None else scope.expression(one) for one in (node.lower, node.upper, node.step)]
        if all(one is None or one.is_fixed for one in parts):
            return constant(slice(*[None if one is None else one.fixed for one in parts]))
        codes = ["" if one is None else scope.lift(one, node).code for one in parts]
        return Value(None, ":".join(codes[: 3 if codes[2] else 2]))
    return scope.expression(node)


def element(scope: "Expressions", node: ast.Subscript, base: Value) -> Value:
    """Returns an element or a part of an array."""
    base = scope.lift(base, node)
    code, left, shape = array_index(scope, node, base.kind)
    dtype = base.kind.dtype
    source = base.raw or base.code
    if left == 0:
        return Value(scalar_of(dtype), converted(f"{source}[{code}]", scalar_of(dtype)))
    part = f"{source}[{code}]"
    kind = Array(dtype, left, shape)
    return Value(kind, f"({part} != 0)" if base.raw else part, views=base.views)


def array_index(scope: "Expressions", node: ast.Subscript, kind: Array) -> tuple[str, int, tuple[int, ...] | None]:
    """Returns the code of an array's index, the dimensions that are left, and the shape of the part if it is known."""
    items = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    if not items:
        raise scope.refuse(node, "an empty index of an array", "write array[:]")
    is_local = isinstance(node.value, ast.Name) and scope.names.is_local(node.value.id)
    codes: list[str] = []
    left: list[int | None] = []
    position = 0
    for item in items:
        value = index_value(scope, item)
        if value.is_fixed and isinstance(value.fixed, slice):
            if is_local and not isinstance(item, ast.Slice):  # the syntax must show whether it is an element
                raise scope.refuse(item, "a slice kept in a variable as the index of a local array", "write array[0:2]")
            size = None if kind.shape is None or position >= kind.ndim else kind.shape[position]
            left.append(None if size is None else len(range(size)[value.fixed]))
            parts = ["" if one is None else str(one) for one in (value.fixed.start, value.fixed.stop, value.fixed.step)]
            codes.append(":".join(parts[: 3 if parts[2] else 2]))
            position += 1
            continue
        if value.kind is None and not value.is_fixed:
            left.append(None)
            codes.append(value.code)
            position += 1
            continue
        value = scope.lift(value, item)
        if isinstance(value.kind, TupleKind) and len(items) == 1 and all(one == INT for one in value.kind.items):
            codes.append(value.code)
            position += len(value.kind.items)
            break
        if not isinstance(value.kind, Scalar) or "float" in value.kind.name or value.kind.name == "mixed":
            advice = "use integers" if isinstance(value.kind, Scalar) else "write a loop over the elements"
            raise scope.refuse(item, f"{in_words(value.kind)} as the index of an array", advice)
        if value.kind == BOOL:
            raise scope.refuse(item, "a boolean as the index of an array", "write int(...)")
        codes.append(value.code)
        position += 1
    if position > kind.ndim:
        raise scope.refuse(node, f"{position} indices for {in_words(kind)}", "use one index for each dimension")
    dims = len(left) + kind.ndim - position
    known = kind.shape is not None and None not in left
    shape = (*left, *kind.shape[position:]) if known and kind.shape is not None else None
    return ", ".join(codes), dims, shape  # type: ignore[return-value]


def elements(scope: "Expressions", node: ast.AST, value: Value) -> list[Value]:
    """Returns the elements of a tuple or of an array whose shape is known."""
    if value.is_fixed and not specials.is_special(value.fixed):
        try:
            return [constant(one) for one in value.fixed]
        except TypeError:
            raise scope.refuse(node, "this has no elements", "use a tuple or an array") from None
    if value.parts is not None:
        return list(value.parts)
    if isinstance(value.kind, TupleKind):
        if len(value.kind.items) != 1:
            scope.no_effects(value, node, "a call whose result is used several times")
        return [scope.element(value, i) for i in range(len(value.kind.items))]
    if isinstance(value.kind, Array):
        return elements(scope, node, as_tuple(scope, node, value))
    raise scope.refuse(node, f"the elements of {in_words(value.kind)}", "use a tuple or an array")


def as_tuple(scope: "Expressions", node: ast.AST, value: Value) -> Value:
    """Returns the elements of a vector of known length as a tuple."""
    kind = value.kind
    if not isinstance(kind, Array) or kind.ndim != 1 or kind.shape is None:
        raise scope.refuse(node, f"the elements of {in_words(kind)}", "use the elements one by one: x[0], x[1]")
    scalar = scalar_of(kind.dtype)
    name = scope.program.elements(kind.shape[0], scalar)
    scope.compiled.uses.add(name)
    return Value(TupleKind((scalar,) * kind.shape[0]), f"{name}({value.code})")


def copied(value: Value, are_rows_new: bool = False) -> Value:
    """Returns a new tuple or list with the same elements; those that are lists or arrays may have other names.

    Args:
        value: The tuple or list.
        are_rows_new: Whether its elements are new as well if they are tuples, like those of ``zip``.
    """

    def is_number(kind: Any) -> bool:
        return isinstance(kind, Scalar) or (are_rows_new and has_numbers(kind))

    are_numbers = all(map(is_number, value.kind.items))
    return replace(value, fresh=True, views=frozenset() if are_numbers else value.views)


def has_numbers(kind: Any) -> bool:
    """Returns whether a kind is that of a tuple or a list of numbers."""
    return isinstance(kind, TupleKind) and all(isinstance(item, Scalar) for item in kind.items)


def lookup(scope: "Expressions", node: ast.AST, container: Any, index: Value) -> Value:
    """Returns an element of a constant container, at an index that is known at run time."""
    is_dict = isinstance(container, dict)
    if not is_dict and type(container) not in (tuple, list):
        made = type(container).__name__
        raise scope.refuse(node, f"an element of an object of type {made}", "use a NumPy array, a tuple or a dict")
    keys = list(container) if is_dict else list(range(len(container)))
    values = [scope.lift(constant(one), node) for one in (container.values() if is_dict else container)]
    if not values:
        raise scope.refuse(node, "an element of an empty container", "fill it in __init__")
    kind: Any = values[0].kind
    for value in values[1:]:
        kind = None if kind is None else join(kind, value.kind)
    if kind is None or (isinstance(kind, Array) and kind.shape is None):
        raise scope.refuse(node, "the elements of a container have several types", "use numbers of one type")
    if isinstance(index.kind, Scalar) and index.kind != INT and index.kind.name[:3] not in ("int", "uin"):
        raise scope.refuse(node, f"{in_words(index.kind)} as an index", "use an integer")
    if is_dict and keys != list(range(len(keys))):
        return _cases(scope, node, keys, values, kind, index)
    columns = list(container.values() if is_dict else container)
    return _table(scope, node, columns, kind, index, "h_key" if is_dict else "h_index")


def _table(scope: "Expressions", node: ast.AST, rows: list[Any], kind: Any, index: Value, check: str) -> Value:
    program = scope.program

    def read(kind: Any, rows: list[Any]) -> str:
        if isinstance(kind, TupleKind):
            return "(" + "".join(read(item, [row[i] for row in rows]) + ", " for i, item in enumerate(kind.items)) + ")"
        if isinstance(kind, Array):
            return f"{program.array(np.array(rows))}[i]"
        if isinstance(kind, Scalar):
            dtypes = {"int": np.int64, "float": np.float64, "mixed": np.float64, "bool": np.bool_}
            return converted(f"{program.array(np.array(rows, dtypes.get(kind.name, kind.name)))}[i]", kind)
        raise scope.refuse(node, f"{in_words(kind)} in a container", "use numbers, tuples or arrays")

    if index.kind != INT and not isinstance(index.kind, Scalar):
        raise scope.refuse(node, f"{in_words(index.kind)} as an index", "use an integer")
    if _has_mixed(kind):
        raise scope.refuse(node, "integers and floats in one container", "write floats everywhere, such as 0.0 for 0")
    result = read(kind, rows)
    name = program.new_name("element")
    lines = [f"def {name}(key):", f"    i = {check}(key, {len(rows)})", f"    return {result}"]
    program.add(name, lines, uses={check})
    scope.compiled.uses.add(name)
    return Value(kind, f"{name}({index.code})", frozen=isinstance(kind, Array))


def _has_mixed(kind: Any) -> bool:
    if isinstance(kind, TupleKind):
        return any(_has_mixed(item) for item in kind.items)
    return bool(kind == Scalar("mixed"))


def _cases(scope: "Expressions", node: ast.AST, keys: list[Any], values: list[Value], kind: Any, index: Value) -> Value:
    program = scope.program
    if len(keys) > MAX_CASES:
        raise scope.refuse(node, f"a dict with {len(keys)} keys", "use a NumPy array indexed by integers")
    codes = [scope.lift(constant(key), node) for key in keys]
    if any(code.kind != index.kind for code in codes) or _has_mixed(kind):
        raise scope.refuse(node, f"{in_words(index.kind)} as the key of a dict", "use integers as keys")
    name = program.new_name("value")
    lines = [f"def {name}(key):"]
    for code, value in zip(codes, values, strict=True):
        lines += [f"    if key == {code.code}:", f"        return {value.code}"]
    program.add(name, [*lines, "    raise KeyError"])
    scope.compiled.uses.add(name)
    return Value(kind, f"{name}({index.code})")
