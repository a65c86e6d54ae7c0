"""The order of evaluation: an array that is read, and changed by a call later in the same statement."""

import ast
from functools import partial
from typing import TYPE_CHECKING

from qtab.compilation.not_compilable import NotCompilable

if TYPE_CHECKING:
    from qtab.compilation.rewriting.scope import Scope


def check_order(scope: "Scope", statement: ast.AST) -> None:
    """Notes the arrays and lists of attributes that a later call in a statement may change.

    In Python they are references, which show the change; compiled code copies them where they are read. They are
    refused if the attribute is changed in place anywhere.
    """
    references = [*scope.references, *_augmented(statement)]
    if not scope.changing or not references:
        return
    parents = {id(inner): one for one in ast.walk(statement) for inner in ast.iter_child_nodes(one)}
    for node, views in references:
        parent = parents.get(id(node), statement)
        outer = parents.get(id(parent))
        if isinstance(parent, ast.Attribute) and isinstance(outer, ast.Call) and outer.func is parent:
            parent = outer  # a method of the array
        inside = {id(one) for one in ast.walk(parent)}
        for call in scope.changing:
            if id(call) in inside and call is not parent and _end(node) <= _begin(call):
                names = " and ".join(f"self.{name}" for name in sorted(views))
                reason = f"{names} is read, and may be changed by `{ast.unparse(call)}` before it is used,"
                error = scope.refuse(node, reason, "assign the call to a variable in a statement before")
                scope.program.aliases.append((scope.compiled, views, partial(_refusal, error)))


def _refusal(error: NotCompilable) -> NotCompilable:
    return error


def _augmented(statement: ast.AST) -> list[tuple[ast.expr, frozenset[str]]]:
    """Returns the attribute of an array or a part of it that an augmented assignment reads."""
    if not isinstance(statement, ast.AugAssign):
        return []
    target: ast.expr = statement.target
    if isinstance(target, ast.Subscript) and any(isinstance(one, ast.Slice) for one in ast.walk(target.slice)):
        target = target.value
    is_attribute = isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name)
    return [(statement.target, frozenset([target.attr]))] if is_attribute else []  # type: ignore[attr-defined]


def _begin(node: ast.AST) -> tuple[int, int]:
    return getattr(node, "lineno", 0), getattr(node, "col_offset", 0)


def _end(node: ast.AST) -> tuple[int, int]:
    return getattr(node, "end_lineno", None) or 0, getattr(node, "end_col_offset", None) or 0
