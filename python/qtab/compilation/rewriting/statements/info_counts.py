"""Numbers that are counted in an info dict, as in ``info["falls"] += 1``; they are left out."""

import ast
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from qtab.compilation.rewriting.attributes import MISSING
from qtab.compilation.rewriting.infos.dicts import KEY
from qtab.compilation.rewriting.statements.effects import check_pure
from qtab.compilation.rewriting.statements.left_out import number

if TYPE_CHECKING:
    from qtab.compilation.rewriting.statements.statements import Statements


def is_info_count(scope: "Statements", node: ast.AugAssign) -> bool:
    """Returns whether a statement changes a number of an info dict, and nothing else; it is left out."""
    match node.target:
        case ast.Subscript(value=ast.Name(id=name), slice=ast.Constant(value=key)) if name in scope.infos:
            values = _values(scope.source.node, name, key)
            if key == KEY or not all(value is not None and _is_number(scope, value) for value in values):
                return False
            check_pure(scope, node.value)
            scope.program.changes_infos = True
            return True
    return False


def _is_number(scope: "Statements", node: ast.expr) -> bool:
    """Returns whether an expression is a number, and was one where it was evaluated."""
    names = [one.id for one in ast.walk(node) if isinstance(one, ast.Name)]
    return number(scope, node) is not None and all(scope.names.counts[name] <= 1 for name in names)


def _values(function: ast.AST, name: str, key: Any) -> Iterator[ast.expr | None]:
    """Yields the values that a key of the dict in a variable gets; None for one that may be missing or unknown."""
    parents = {id(inner): one for one in ast.walk(function) for inner in ast.iter_child_nodes(one)}
    for node in ast.walk(function):
        if not (isinstance(node, ast.Name) and node.id == name):
            continue
        parent = parents[id(node)]
        above = parents.get(id(parent))
        match parent, above:
            case ast.Tuple(), ast.Return():
                pass
            case (ast.Assign(targets=[_]) | ast.AnnAssign(), _) if isinstance(node.ctx, ast.Store):
                yield _item(parent.value, key)
            case (ast.Subscript(), ast.AugAssign()) | (ast.Subscript(ctx=ast.Load()), _):  # others refuse to read it
                pass
            case ast.Subscript(slice=ast.Constant(value=other), ctx=ast.Store()), ast.Assign() | ast.AnnAssign():
                if other == key:
                    yield above.value
            case _:  # it may have another name
                yield None


def _item(node: ast.expr | None, key: Any) -> ast.expr | None:
    """Returns the value of a key in a dict that is written out; None if it may be missing or unknown."""
    if not isinstance(node, ast.Dict):
        return None
    keys = [one.value if isinstance(one, ast.Constant) else MISSING for one in node.keys]
    found = [value for one, value in zip(keys, node.values, strict=True) if one == key]
    return found[-1] if found and MISSING not in keys else None
