"""Info dicts that a class changes: they must be its own, as compiled code leaves out the changes."""

import ast
from collections.abc import Iterator
from types import FunctionType

import gymnasium as gym

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.attributes import Attributes
from qtab.compilation.rewriting.infos.dicts import LENGTHS, own_name, returns_of
from qtab.compilation.rewriting.source.sources import Source, source_of
from qtab.compilation.rewriting.source.syntax import info_names

ADVICE = "make it here, as in {'cell': self.cell}"
MOST_NESTED = 4


def check_changed_infos(attributes: Attributes) -> None:
    """Refuses a class that changes an info dict after it has returned or taken one that it has not made.

    Other code may read such a dict, as one of the module, and compiled code would neither change it nor see the change.

    Raises:
        NotCompilable: with the line where it is taken or returned.
    """
    sources = list(_methods(attributes))
    if not any(_changed(source) for source in sources):
        return
    for source in sources:
        assigned = [value for name in sorted(_names(source)) for value in _values(source, name)]
        for node in [*assigned, *_returned(source.node)]:
            if not _is_new(attributes, source, node):
                line, text = getattr(node, "lineno", source.node.lineno), ast.unparse(node)
                raise NotCompilable(
                    f"an info dict is changed, and `{text}` was not made here", source.file, line, ADVICE
                )


def _methods(attributes: Attributes) -> Iterator[Source]:
    order = attributes.cls.__mro__
    for cls in order[: order.index(gym.Env)]:
        for role in LENGTHS:
            if isinstance(member := vars(cls).get(role), FunctionType):
                yield source_of(member)


def _names(source: Source) -> set[str]:
    """Returns the names of info dicts: those that are returned last, and those that a ``step`` or ``reset`` gives."""
    found = info_names(source.node)
    for one in ast.walk(source.node):
        if isinstance(one, ast.Assign) and any(map(_is_info, ast.walk(one.value))):
            for target in one.targets:
                last = target.elts[-1] if isinstance(target, ast.Tuple | ast.List) else target
                if isinstance(last, ast.Name):
                    found.add(last.id)
    return found


def _is_info(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in LENGTHS


def _changed(source: Source) -> bool:
    """Returns whether a method changes an info dict."""
    names = _names(source)
    for one in ast.walk(source.node):
        base: ast.AST | None = None
        if isinstance(one, ast.Subscript) and not isinstance(one.ctx, ast.Load):
            base = one.value
        elif isinstance(one, ast.Call) and isinstance(one.func, ast.Attribute):
            base = one.func.value
        elif isinstance(one, ast.AugAssign):
            base = one.target
        if isinstance(base, ast.Name) and base.id in names:
            return True
    return False


def _returned(node: ast.FunctionDef) -> Iterator[ast.expr]:
    """Yields what a function returns, of a tuple its last element."""
    for one in returns_of(node):
        if one.value is not None:
            yield one.value.elts[-1] if isinstance(one.value, ast.Tuple) and one.value.elts else one.value


def _values(source: Source, name: str) -> Iterator[ast.expr]:
    """Yields the values that are assigned to a variable; the call, if it is unpacked from one."""
    for one in ast.walk(source.node):
        targets = one.targets if isinstance(one, ast.Assign) else [one.target] if isinstance(one, ast.AnnAssign) else []
        for target in targets:
            value = one.value  # type: ignore[attr-defined]
            if isinstance(target, ast.Name) and target.id == name and value is not None:
                yield value
            elif isinstance(target, ast.Tuple | ast.List):
                for i, part in enumerate(target.elts):
                    if isinstance(part, ast.Name) and part.id == name:
                        yield value.elts[i] if isinstance(value, ast.Tuple | ast.List) else value


def _is_new(attributes: Attributes, source: Source, node: ast.expr, depth: int = 0) -> bool:
    """Returns whether an expression is a dict that nothing else refers to."""
    if depth > MOST_NESTED:
        return False

    def is_new(one: ast.expr) -> bool:
        return _is_new(attributes, source, one, depth + 1)

    if isinstance(node, ast.Dict | ast.DictComp | ast.BinOp):
        return True
    if isinstance(node, ast.IfExp):
        return is_new(node.body) and is_new(node.orelse)
    if isinstance(node, ast.Name):
        values = list(_values(source, node.id))
        return bool(values) and all(map(is_new, values))
    if not isinstance(node, ast.Call):
        return False
    function = node.func
    if isinstance(function, ast.Name):
        return function.id == "dict"
    if not isinstance(function, ast.Attribute):
        return False
    if function.attr == "copy" or _is_info(node):  # of a base class, which is checked as well
        return True
    member, _ = attributes.find(function.attr)
    if not (isinstance(function.value, ast.Name) and function.value.id == own_name(source)):
        return False
    if not isinstance(member, FunctionType):
        return False
    inner = source_of(member)
    return all(_is_new(attributes, inner, one, depth + 1) for one in _returned(inner.node))
