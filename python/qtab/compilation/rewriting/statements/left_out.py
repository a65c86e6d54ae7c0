"""What compiled code leaves out, such as info dicts: whether Python could raise an error, or warn, in computing it."""

import ast
import builtins
from types import FunctionType
from typing import TYPE_CHECKING

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.source.sources import source_of
from qtab.compilation.rewriting.statements.effects import check_pure, resolved
from qtab.compilation.rewriting.statements.failures import STALE, Failures, LeftOut
from qtab.compilation.rewriting.values import Kind, kind_of

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions
    from qtab.compilation.rewriting.program import Program
    from qtab.compilation.rewriting.statements.statements import Statements

REASON = "this is left out in compiled code, and might raise an error or warn in Python, in"
ADVICE = "use only constants, attributes, variables that are set on every path, and comparisons, +, - and * of numbers"


def note(scope: "Expressions", node: ast.AST, attribute: str = "", *, refused: bool = False) -> None:
    """Notes an expression that is left out.

    Args:
        scope: The function.
        node: The expression.
        attribute: The attribute that it is assigned to, if any.
        refused: Whether it is refused, whatever it is.
    """
    parameters = scope.names.parameters
    names = [*parameters, *(name for name in scope.names.counts if scope.is_set(name))]
    local = {name: _kind_of_local(scope, name) for name in names}
    own = parameters[0] if parameters and scope.owner is not None else ""
    line = getattr(node, "lineno", scope.source.node.lineno)
    program, all_names = scope.program, frozenset(scope.names.counts)
    assigned = frozenset(scope.flow.assigned | program.assigned_by_reset)
    found = LeftOut(scope.source.function, node, line, scope.source.file, own, local, all_names, assigned, refused)
    program.left_out.append(found)
    if attribute:
        program.stale.setdefault(attribute, []).append(found)
        scope.flow.assigned.add(f"{STALE}{attribute}")


def _kind_of_local(scope: "Expressions", name: str) -> Kind | None:
    value = scope.fixed.get(name) or scope.parameters.get(name)
    if name in scope.fixed or (value is not None and scope.kind_of_local(name) is None):
        return kind_of(value.fixed) if value.is_fixed else value.kind  # type: ignore[union-attr]
    return scope.kind_of_local(name)


def is_update(scope: "Statements", node: ast.expr) -> bool:
    """Returns whether an expression is ``info.update(...)``, which is left out and noted."""
    if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "update"):
        return False
    base = node.func.value
    if not (isinstance(base, ast.Name) and base.id in scope.infos):
        return False
    for one in (*node.args, *[keyword.value for keyword in node.keywords]):
        check_pure(scope, one)
        note(scope, one)
    check_changed(scope, node, base.id)
    if not scope.is_set(base.id) or not all(isinstance(one, ast.Dict) for one in node.args):
        note(scope, node, refused=True)
    return True


def check_changed(scope: "Expressions", node: ast.AST, name: str) -> None:
    """Refuses to change an info dict that was not made by the function, and that others may therefore use.

    Raises:
        NotCompilable: if it is not known to be made by it.
    """
    if not scope.new_infos.get(name, False):
        raise scope.refuse(node, "an info dict is changed that other code may use", f"make it here: {name} = {{...}}")


def is_new(scope: "Expressions", node: ast.expr) -> bool:
    """Returns whether an info dict is made where it is assigned or returned."""
    if isinstance(node, ast.Name):
        return scope.new_infos.get(node.id, False)
    if isinstance(node, ast.Dict):
        return True
    if not isinstance(node, ast.Call):
        return False
    function = node.func
    if isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name):
        member, _ = scope.program.attributes.find(function.attr)
        if isinstance(member, FunctionType):
            body = source_of(member).node.body
            return all(isinstance(one.value, ast.Dict) for part in body for one in ast.walk(part) if _returns(one))  # type: ignore[attr-defined]
    return resolved(function, scope.source.function) is builtins.dict


def _returns(node: ast.AST) -> bool:
    return isinstance(node, ast.Return)


def refusal(program: "Program") -> NotCompilable | None:
    """Returns the error for the first expression left out that might raise an error in Python; None without any."""
    for one in program.left_out:
        found: ast.AST | None = one.node if one.refused else Failures(program, one).fails(one.node)
        if found is not None:
            text = ast.unparse(one.node).splitlines()[0]
            return NotCompilable(f"{REASON} `{text[:90]}`", one.file, one.line, ADVICE)
    return None
