"""What compiled code leaves out, although Python may raise an error or log a message there."""

import ast
import builtins
from typing import TYPE_CHECKING, Any

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.attributes import MISSING
from qtab.compilation.rewriting.program import STALE
from qtab.compilation.rewriting.source.syntax import GROWING
from qtab.compilation.rewriting.statements.effects import check_pure, constant_of
from qtab.compilation.rewriting.values import Array, Scalar, kind_of

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions
    from qtab.compilation.rewriting.statements.statements import Statements

EXACT = (ast.Add, ast.Sub, ast.Mult)
"""The operators that never fail for numbers."""
NEVER_FAIL = (abs, bool, float, str)


def note_value(scope: "Expressions", node: ast.AST, *parts: ast.expr) -> None:
    """Notes the value of an attribute that is never read, if Python may raise an error in computing it.

    Args:
        scope: The function.
        node: The statement.
        parts: The value; for an augmented assignment, numbers that are added, subtracted or multiplied.
    """
    operator = getattr(node, "op", None)
    if operator is None:
        is_safe = all(_is_safe(scope, one) for one in parts)
    else:
        is_safe = isinstance(operator, EXACT) and all(_is_number(scope, one) for one in parts)
    if not is_safe:
        reason = "an error might be raised here, in a value that compiled code leaves out as nothing reads it,"
        scope.program.left_out.append(scope.refuse(node, reason, "leave it out"))


def note_attribute(scope: "Expressions", node: ast.AST, name: str, is_changed: bool = False) -> None:
    """Notes an assignment to an attribute that is never read.

    Args:
        scope: The function.
        node: The statement.
        name: The attribute.
        is_changed: Whether its value before is used, as in an augmented assignment.
    """
    if not is_changed:
        scope.flow.assigned.add(f"{STALE}{name}")
    reason = f"self.{name} keeps its value from one episode to the next, and compiled code leaves it out,"
    scope.program.stale.setdefault(name, scope.refuse(node, reason, f"assign self.{name} in reset"))


def is_info_update(scope: "Statements", node: ast.expr) -> bool:
    """Returns whether an expression is ``info.update(...)``, which is left out."""
    match node:
        case ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr="update")) if name in scope.infos:
            for value in (*node.args, *[keyword.value for keyword in node.keywords]):
                check_pure(scope, value)
            return True
    return False


def is_growing_list(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether a statement only adds to a list that ``reset`` has made, and that is never read; it is noted."""
    match node:
        case ast.Call(func=ast.Attribute(value=ast.Attribute(value=ast.Name(id=own), attr=name), attr=method)):
            program = scope.program
            known = program.attributes
            base = scope.fixed.get(own)
            is_left_out = name in known.growing and method in GROWING and name not in known.read
            is_made = f"{STALE}{name}" in scope.flow.assigned
            if program.phase == "step":  # unknown if reset cannot be compiled
                is_made = program.stale_in_reset is None or name in program.stale_in_reset
            if base is None or base.fixed is not specials.SELF or not (is_left_out and is_made):
                return False
            values = [*node.args, *[keyword.value for keyword in node.keywords]]
            for value in values:
                check_pure(scope, value)
            note_value(scope, node, *values)
            note_attribute(scope, node, name, is_changed=True)
            return True
    return False


def note_message(scope: "Expressions", node: ast.AST) -> None:
    """Notes a call of ``gymnasium.logger``."""
    reason = "a message is logged, which compiled code leaves out,"
    scope.program.left_out.append(scope.refuse(node, reason, "leave it out, or log in a wrapper"))


def _is_safe(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether Python computes an expression without an error, whatever the state is."""

    def all_safe(parts: list[ast.expr]) -> bool:
        return all(_is_safe(scope, one) for one in parts)

    match node:
        case ast.Constant():
            return True
        case ast.Name(id=name):
            return name in scope.fixed or scope.is_set(name) or not scope.names.is_local(name)
        case ast.Attribute():
            own = next(iter(scope.parameters), None)
            is_constant = constant_of(scope, node, scope.source.function, own) is not MISSING
            return is_constant or _known(scope, node) is not MISSING
        case ast.Call(func=ast.Attribute(value=value, attr="copy"), args=[], keywords=[]):
            return isinstance(kind_of(_known(scope, value)), Array)
        case ast.Tuple(elts=parts) | ast.List(elts=parts) | ast.BoolOp(values=parts):
            return all_safe(parts)
        case ast.IfExp(test=test, body=body, orelse=other):
            return all_safe([test, body, other])
        case ast.Dict(keys=keys, values=values):
            return all(isinstance(key, ast.Constant) for key in keys) and all_safe(values)
    return _is_number(scope, node)


def _is_number(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether an expression is a number, which Python computes without an error."""
    match node:
        case ast.Constant(value=value):
            return isinstance(value, bool | int | float)
        case ast.Name(id=name):
            is_number = isinstance(scope.kind_of_local(name), Scalar) or isinstance(
                kind_of(_known(scope, node)), Scalar
            )
            return is_number and _is_safe(scope, node)
        case ast.Attribute():
            return isinstance(kind_of(_known(scope, node)), Scalar)
        case ast.BinOp(left=left, op=op, right=right):
            return isinstance(op, EXACT) and _is_number(scope, left) and _is_number(scope, right)
        case ast.UnaryOp(op=op, operand=operand):
            return not isinstance(op, ast.Invert) and _is_number(scope, operand)
        case ast.Compare(left=left, ops=ops, comparators=others):
            simple = not any(isinstance(op, ast.In | ast.NotIn) for op in ops)
            return simple and all(_is_number(scope, one) for one in (left, *others))
        case ast.IfExp(test=test, body=body, orelse=other):
            return all(_is_number(scope, one) for one in (test, body, other))
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]):
            is_builtin = name not in scope.source.function.__globals__ and not scope.names.is_local(name)
            return is_builtin and getattr(builtins, name, None) in NEVER_FAIL and _is_number(scope, argument)
    return False


def _known(scope: "Expressions", node: ast.expr) -> Any:
    """Returns a constant, or a value that an attribute of the environment may have; ``MISSING`` if there is none."""
    if isinstance(node, ast.Name):
        found = scope.fixed.get(node.id)
        return MISSING if found is None else found.fixed
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        known = scope.program.attributes
        own = next(iter(scope.parameters), None)
        member, _ = known.find(node.attr)
        if node.value.id == own and not hasattr(type(member), "__get__"):
            return vars(known.twin).get(node.attr, member)
    return MISSING
