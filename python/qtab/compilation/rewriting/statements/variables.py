"""Values in variables of the program, so that their code is evaluated once."""

import ast
from dataclasses import replace
from typing import TYPE_CHECKING

from qtab.compilation.rewriting.library.arrays import copied
from qtab.compilation.rewriting.program import tuple_value
from qtab.compilation.rewriting.values import INFO, Array, DictKind, Value

if TYPE_CHECKING:
    from qtab.compilation.rewriting.statements.statements import Statements


def is_simple(value: Value) -> bool:
    """Returns whether the code of a value is a name."""
    return value.code.isidentifier()


def in_variables(scope: "Statements", node: ast.stmt, value: Value) -> Value:
    """Returns a value whose code is evaluated once, in variables of the program."""
    if value.parts is not None:
        parts = []
        for part in value.parts:
            fixed = part.is_fixed or part.kind == INFO
            parts.append(part if fixed else in_variables(scope, node, kept(part)))
        made = tuple_value(tuple(parts))
        return _like(value, replace(made, views=made.views | value.views))
    scope.temporaries += 1
    name = f"x_{scope.temporaries}"
    scope.emit(f"{name} = {kept(value).code}", node)
    return Value(value.kind, name, fresh=value.fresh, views=value.views)


def kept(value: Value) -> Value:
    """Returns a value for a name: arrays of the record and parts of arrays are copied."""
    if isinstance(value.kind, Array) and not (value.fresh or value.frozen or value.code.isidentifier()):
        return Value(value.kind, copied(value).code, views=value.views)
    if value.parts is not None and any(part.kind != INFO for part in value.parts):
        made = tuple_value(tuple(kept(part) for part in value.parts))
        return _like(value, replace(made, views=made.views | value.views))
    return value


def _like(value: Value, made: Value) -> Value:
    """Returns the elements of a dict with its keys."""
    return replace(made, kind=value.kind) if isinstance(value.kind, DictKind) else made
