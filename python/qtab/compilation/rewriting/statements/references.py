"""Values that may be objects with other names, which would show a change in place."""

import ast
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from qtab.compilation.rewriting.infos.made import bindings, values_of
from qtab.compilation.rewriting.source.syntax import own_name
from qtab.compilation.rewriting.statements.effects import constant_of
from qtab.compilation.rewriting.statements.left_out import known_value

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

_MADE = (ast.Constant, ast.JoinedStr, ast.Tuple, ast.List, ast.ListComp, ast.Dict, ast.Set, ast.BinOp, ast.Compare)
_MAKE = (dict, list, set, sorted)


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


def is_new(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether an expression makes a value to which no other name refers, or is a constant."""
    match node:
        case ast.IfExp(body=body, orelse=other):
            return is_new(scope, body) and is_new(scope, other)
        case ast.BoolOp(values=values):
            return all(is_new(scope, one) for one in values)
        case ast.Call(func=ast.Name() as function):
            return any(constant_of(scope, function, scope.source.function, None) is one for one in _MAKE)
        case ast.Call(func=ast.Attribute(value=owner, attr="copy" | "tolist")):
            return _has_library_methods(scope, owner)
    return isinstance(node, _MADE)


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
    return isinstance(known_value(scope, node), dict | list | set | np.ndarray)
