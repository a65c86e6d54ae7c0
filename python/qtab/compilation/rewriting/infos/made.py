"""Dicts, lists and arrays that a function makes itself, so that nothing else refers to them."""

import ast
from collections.abc import Iterator
from types import FunctionType

from qtab.compilation.rewriting.attributes import MISSING, Attributes
from qtab.compilation.rewriting.infos.dicts import LENGTHS, returns_of
from qtab.compilation.rewriting.source.sources import Source, source_of
from qtab.compilation.rewriting.source.syntax import own_name, parameters_of

MOST_NESTED = 4
_DISPLAYS = (ast.Dict, ast.DictComp, ast.List, ast.ListComp, ast.Set, ast.SetComp, ast.BinOp)
_MAKE = ("dict", "list", "set", "sorted")
_MAKE_ARRAYS = ("arange", "array", "empty", "full", "full_like", "ones", "ones_like", "zeros", "zeros_like")


def is_made(attributes: Attributes, source: Source, node: ast.expr, depth: int = 0) -> bool:
    """Returns whether an expression makes a dict, a list or an array, or is a variable with nothing else."""
    if depth > MOST_NESTED:
        return False

    def made(one: ast.expr) -> bool:
        return is_made(attributes, source, one, depth + 1)

    if isinstance(node, _DISPLAYS):
        return True
    if isinstance(node, ast.IfExp):
        return made(node.body) and made(node.orelse)
    if isinstance(node, ast.Name):
        if source.node.args.kwarg is not None and node.id == source.node.args.kwarg.arg:
            return True
        if node.id in parameters_of(source.node):
            return False
        values = list(values_of(source, node.id))
        return bool(values) and len(values) == bindings(source, node.id) and all(map(made, values))
    if not isinstance(node, ast.Call):
        return False
    function = node.func
    if isinstance(function, ast.Name):
        return function.id in _MAKE
    if not isinstance(function, ast.Attribute):
        return False
    owner = function.value.id if isinstance(function.value, ast.Name) else None
    is_copy = function.attr == "copy" and attributes.find("copy")[0] is MISSING
    if is_copy or is_step(node):  # of a base class, which is checked as well
        return True
    if owner is None:
        return False
    if owner in ("np", "numpy"):
        return function.attr in _MAKE_ARRAYS and not any(keyword.arg == "copy" for keyword in node.keywords)
    member, _ = attributes.find(function.attr)
    if owner != own_name(source.node) or not isinstance(member, FunctionType):
        return False
    inner = source_of(member)
    return all(is_made(attributes, inner, one, depth + 1) for one in returned(inner.node))


def is_step(node: ast.AST) -> bool:
    """Returns whether an expression calls ``step`` or ``reset``, such as those of a base class."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in LENGTHS


def returned(node: ast.FunctionDef) -> Iterator[ast.expr]:
    """Yields what a function returns, of a tuple its last element."""
    for one in returns_of(node):
        if one.value is not None:
            yield one.value.elts[-1] if isinstance(one.value, ast.Tuple) and one.value.elts else one.value


def values_of(source: Source, name: str) -> Iterator[ast.expr]:
    """Yields the values that are assigned to a variable; the call, for the info dict of ``step`` or ``reset``."""
    for one in ast.walk(source.node):
        targets = one.targets if isinstance(one, ast.Assign) else [one.target] if isinstance(one, ast.AnnAssign) else []
        for target in targets:
            value = one.value  # type: ignore[attr-defined]
            if isinstance(target, ast.Name) and target.id == name and value is not None:
                yield value
            elif isinstance(target, ast.Tuple | ast.List):
                for i, part in enumerate(target.elts):
                    if isinstance(part, ast.Name) and part.id == name:
                        yield _element(target, value, i)


def _element(target: ast.Tuple | ast.List, value: ast.expr, i: int) -> ast.expr:
    """Returns the value of an element of a target; of a call of ``step`` or ``reset``, the call for the last."""
    has_star = any(isinstance(part, ast.Starred) for part in target.elts)
    if isinstance(value, ast.Tuple | ast.List) and not has_star and len(value.elts) == len(target.elts):
        return value.elts[i]
    is_last = is_step(value) and not has_star and i == len(target.elts) - 1
    return value if is_last else ast.copy_location(ast.Subscript(value, ast.Constant(i), ast.Load()), value)


def bindings(source: Source, name: str) -> int:
    """Returns how often a variable gets a value, also by a loop or a pattern; ``+=`` does not count."""
    changed = {id(one.target) for one in ast.walk(source.node) if isinstance(one, ast.AugAssign)}
    names = [one for one in ast.walk(source.node) if isinstance(one, ast.Name) and id(one) not in changed]
    patterns = [one for one in ast.walk(source.node) if isinstance(one, ast.MatchAs | ast.MatchStar | ast.MatchMapping)]
    captured = [one.rest if isinstance(one, ast.MatchMapping) else one.name for one in patterns]
    return sum(one.id == name and isinstance(one.ctx, ast.Store) for one in names) + captured.count(name)
