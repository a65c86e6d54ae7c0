"""Values that may be objects with other names, which would show a change in place."""

import ast
from collections.abc import Iterator
from types import FunctionType
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.infos.dicts import returns_of
from qtab.compilation.rewriting.infos.made import bindings, values_of
from qtab.compilation.rewriting.source.sources import source_of
from qtab.compilation.rewriting.source.syntax import own_name
from qtab.compilation.rewriting.statements.effects import constant_of
from qtab.compilation.rewriting.statements.left_out import known_value

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

_MADE = (ast.Constant, ast.JoinedStr, ast.Tuple, ast.List, ast.ListComp, ast.Dict, ast.Set, ast.BinOp, ast.Compare)
_MAKE = (dict, list, set, sorted)
_COLLECTIONS = (dict, list, set, np.ndarray)


def shared_names(scope: "Expressions", target: ast.expr, value: ast.expr, is_alone: bool) -> Iterator[str]:
    """Yields the attributes of a target whose values may be objects with other names.

    Args:
        scope: The function.
        target: The target of an assignment.
        value: The value that is assigned.
        is_alone: Whether the value is assigned to no other target.
    """
    if isinstance(target, ast.Attribute):
        if not (is_alone and is_new(scope, value)):
            yield target.attr
    elif isinstance(target, ast.Tuple | ast.List):
        is_written = isinstance(value, ast.Tuple | ast.List) and len(value.elts) == len(target.elts)
        values = value.elts if is_written else [value] * len(target.elts)  # type: ignore[attr-defined]
        for one, part in zip(target.elts, values, strict=True):
            yield from shared_names(scope, one, part, is_alone and is_written)


def is_new(scope: "Expressions", node: ast.expr, within: FunctionType | None = None) -> bool:
    """Returns whether an expression makes a value to which no other name refers, or is a constant.

    Args:
        scope: The function that is rewritten.
        node: The expression.
        within: The function that contains the expression; None if it is the one that is rewritten.
    """
    function = within or scope.source.function
    is_current = function is scope.source.function
    match node:
        case ast.IfExp(body=body, orelse=other):
            return is_new(scope, body, within) and is_new(scope, other, within)
        case ast.BoolOp(values=values):
            return all(is_new(scope, one, within) for one in values)
        case ast.Call(func=ast.Name() as callee) if any(
            constant_of(scope, callee, function, None) is one for one in _MAKE
        ):
            return True
        case ast.Call(func=ast.Attribute(value=owner, attr="copy" | "tolist")) if is_current:
            return _has_library_methods(scope, owner)
        case ast.Call(func=ast.Name() | ast.Attribute() as callee) if is_current:
            called = constant_of(scope, callee, function, own_name(scope.source.node))
            called = getattr(called, "__func__", called)
            return called is not function and returns_new(scope, called)
    return isinstance(node, _MADE)


def returns_new(scope: "Expressions", function: Any) -> bool:
    """Returns whether a function is the user's, and makes every value that it returns."""
    if not isinstance(function, FunctionType) or hasattr(function, "__wrapped__"):
        return False
    try:
        values = [one.value for one in returns_of(source_of(function).node)]
    except NotCompilable:
        return False
    return bool(values) and all(value is not None and is_new(scope, value, function) for value in values)


def is_owned(scope: "Expressions", node: ast.Name) -> bool:
    """Returns whether a variable has only values that the function made and to which no other name refers."""
    values = list(values_of(scope.source, node.id))
    several = [one.value for one in ast.walk(scope.source.node) if isinstance(one, ast.Assign) and len(one.targets) > 1]
    are_all = bool(values) and len(values) == bindings(scope.source, node.id)
    are_own = all(is_new(scope, one) and one not in several for one in values)
    return are_all and are_own and not scope.names.shared_before_change(node.id)


def _has_library_methods(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether the methods of an object are those of a list, a dict, a set or an array."""
    if isinstance(node, ast.Name) and node.id == own_name(scope.source.node):
        return False
    if isinstance(node, ast.Name) and node.id not in scope.fixed and scope.names.is_local(node.id):
        return scope.kind_of_local(node.id) is not None
    if isinstance(node, ast.Subscript) and isinstance(values := known_value(scope, node.value), list | tuple):
        return all(isinstance(one, _COLLECTIONS) for one in values)
    return isinstance(known_value(scope, node), _COLLECTIONS)
