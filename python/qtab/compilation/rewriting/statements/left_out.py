"""What compiled code leaves out, although Python may raise an error or log a message there."""

import ast
import builtins
from typing import TYPE_CHECKING, Any

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.attributes import MISSING
from qtab.compilation.rewriting.program import STALE
from qtab.compilation.rewriting.source.syntax import GROWING
from qtab.compilation.rewriting.statements.effects import check_pure, constant_of
from qtab.compilation.rewriting.values import BOOL, FLOAT, INT, MIXED, Array, Kind, Scalar, TupleKind, kind_of

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions
    from qtab.compilation.rewriting.statements.statements import Statements

EXACT = (ast.Add, ast.Sub, ast.Mult)
"""The operators that never fail for numbers."""
RAISES = "an error might be raised here, in a value that compiled code leaves out as nothing reads it,"
LEAVE_OUT = "compute its numbers in local variables first, or leave it out"


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
        is_safe = _combined(operator, *[number(scope, one) for one in parts]) is not None
    if not is_safe:
        scope.program.left_out.append(scope.refuse(node, RAISES, LEAVE_OUT))


def note_kind(scope: "Expressions", name: str, kind: Kind | None, is_own: bool) -> None:
    """Notes the kind of a value that is assigned to an attribute that is never read.

    Args:
        scope: The function.
        name: The attribute.
        kind: The kind; None if it has none.
        is_own: Whether no other name refers to the value, or it cannot be changed.
    """
    scope.program.stale_kinds.setdefault(name, set()).add(kind)
    if not is_own and not isinstance(kind, Scalar):
        scope.program.stale_objects.add(name)


def note_change(scope: "Expressions", node: ast.AugAssign, target: ast.Attribute) -> None:
    """Notes an augmented assignment to an attribute that is never read: all its values must be such numbers."""
    note_value(scope, node, target, node.value)
    note_attribute(scope, node, target.attr, is_changed=True)
    scope.program.changed_stale.append((target.attr, number(scope, target), scope.refuse(node, RAISES, LEAVE_OUT)))


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
            scope.program.changes_infos = True
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
            is_right = len(node.args) == (method != "clear") and not node.keywords
            if not is_right or (method == "extend" and not _is_sequence(scope, values[0])):
                scope.program.left_out.append(scope.refuse(node, RAISES, LEAVE_OUT))
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
            if scope.names.is_local(name):
                return name in scope.fixed or scope.is_set(name)
            return constant_of(scope, node, scope.source.function, None) is not MISSING
        case ast.Attribute():
            own = next(iter(scope.parameters), None)
            is_constant = constant_of(scope, node, scope.source.function, own) is not MISSING
            return is_constant or known_value(scope, node) is not MISSING
        case ast.Call(func=ast.Attribute(value=value, attr="copy"), args=[], keywords=[]):
            return isinstance(kind_of(known_value(scope, value)), Array)
        case ast.Call(func=ast.Name(id="str"), args=[argument], keywords=[]):
            return _is_builtin(scope, "str") and _is_number(scope, argument)
        case ast.Tuple(elts=parts) | ast.List(elts=parts):
            return all_safe(parts)
        case ast.BoolOp(values=parts):
            return all(_has_truth(scope, one) for one in parts[:-1]) and _is_safe(scope, parts[-1])
        case ast.IfExp(test=test, body=body, orelse=other):
            return _has_truth(scope, test) and all_safe([body, other])
        case ast.Dict(keys=keys, values=values):
            return all(isinstance(key, ast.Constant) for key in keys) and all_safe(values)
    return _is_number(scope, node)


def _has_truth(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether a condition is safe and its truth as well, unlike that of an array."""
    return isinstance(node, ast.Constant) or _is_number(scope, node)


def _is_sequence(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether an expression is a sequence."""
    kind = scope.kind_of_local(node.id) if isinstance(node, ast.Name) else None
    return isinstance(node, ast.Tuple | ast.List) or isinstance(
        kind or kind_of(known_value(scope, node)), Array | TupleKind
    )


def _is_builtin(scope: "Expressions", name: str) -> bool:
    return constant_of(scope, ast.Name(name, ast.Load()), scope.source.function, None) is getattr(builtins, name, None)


def _is_number(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether an expression is a number, which Python computes without an error."""
    return number(scope, node) is not None


def number(scope: "Expressions", node: ast.expr) -> Scalar | None:
    """Returns the kind of a number, which Python computes without an error; None for other expressions.

    The kind of what may be a boolean is a boolean's.
    """

    def any_of(parts: list[ast.expr]) -> Scalar | None:
        kinds = {number(scope, one) for one in parts}
        if len(kinds) == 1:
            return kinds.pop()
        if any(kind is None or _is_small(kind) for kind in kinds):
            return None
        return BOOL if BOOL in kinds else MIXED

    match node:
        case ast.Constant(value=value):
            return _scalar(kind_of(value))
        case ast.Name(id=name):
            kind = _scalar(scope.kind_of_local(name)) or _scalar(kind_of(known_value(scope, node)))
            return kind if _is_safe(scope, node) else None
        case ast.Attribute():
            return _scalar(kind_of(known_value(scope, node)))
        case ast.BinOp(left=left, op=op, right=right):
            return _combined(op, number(scope, left), number(scope, right))
        case ast.UnaryOp(op=op, operand=operand):
            kind = number(scope, operand)
            if isinstance(op, ast.Not):
                return None if kind is None else BOOL
            return None if isinstance(op, ast.Invert) or kind == BOOL else kind
        case ast.Compare(left=left, ops=ops, comparators=others):
            simple = not any(isinstance(op, ast.In | ast.NotIn) for op in ops)
            return BOOL if simple and all(_is_number(scope, one) for one in (left, *others)) else None
        case ast.BoolOp(values=parts):
            return any_of(parts)
        case ast.IfExp(test=test, body=body, orelse=other):
            return any_of([body, other]) if _is_number(scope, test) else None
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if _is_builtin(scope, name):
            kind = number(scope, argument)
            made = {"bool": BOOL, "float": FLOAT, "abs": kind}
            return None if kind is None else made.get(name)
    return None


def _scalar(kind: Kind | None) -> Scalar | None:
    return kind if isinstance(kind, Scalar) else None


def _combined(operator: ast.AST, left: Scalar | None, right: Scalar | None) -> Scalar | None:
    """Returns the kind of a number that an operator gives; None if it may fail.

    NumPy has no difference of booleans, and refuses Python's integers beside its own smaller ones.
    """
    if left is None or right is None or not isinstance(operator, EXACT):
        return None
    if left == right:
        return None if left == BOOL and isinstance(operator, ast.Sub) else left
    return None if _is_small(left) or _is_small(right) else MIXED


def _is_small(kind: Scalar) -> bool:
    """Returns whether numbers are integers of fewer than 64 bits, which overflow beside Python's."""
    return "int" in kind.name and kind != INT


def known_value(scope: "Expressions", node: ast.expr) -> Any:
    """Returns a constant, or a value that an attribute of the environment may have; ``MISSING`` if there is none."""
    if isinstance(node, ast.Name):
        is_local = node.id not in scope.fixed and scope.names.is_local(node.id)
        return MISSING if is_local else constant_of(scope, node, scope.source.function, None)
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        known = scope.program.attributes
        own = next(iter(scope.parameters), None)
        member, _ = known.find(node.attr)
        if node.value.id == own and not hasattr(type(member), "__get__"):
            return vars(known.twin).get(node.attr, member)
        return constant_of(scope, node, scope.source.function, own)
    return MISSING
