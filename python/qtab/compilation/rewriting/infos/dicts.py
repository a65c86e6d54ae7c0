"""The info dicts of a class: whether they are always empty, or hold nothing but the action mask."""

import ast
from collections.abc import Iterator
from types import FunctionType
from typing import TypeAlias

import gymnasium as gym

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.attributes import Attributes
from qtab.compilation.rewriting.source.sources import Source, source_of
from qtab.compilation.rewriting.source.syntax import own_name

KEY = "action_mask"
LENGTHS = {"reset": 2, "step": 5}
MOST_NESTED = 3
ADVICE = "return {}, or a dict that is written out with 'action_mask' alone"

Info: TypeAlias = ast.expr | None
"""The expression of the action mask; None for an empty dict."""
Found: TypeAlias = tuple[Source, ast.AST, Info]
"""An info dict that a function returns in a statement."""


def info_of(attributes: Attributes, alone: bool = True) -> Found:
    """Returns the first info dict of ``reset``; the others have the same action mask, or are empty as well.

    Args:
        attributes: What is known about the environment.
        alone: Whether they must hold nothing else.

    Raises:
        NotCompilable: if they hold something else, or if that is not certain.
    """
    found = [one for role in LENGTHS for one in _of_method(attributes, role, None, alone)]
    for source, node, info in found:
        if _text(info) != _text(found[0][2]):
            raise _refused(source, node, "this info dict has another action mask than others", ADVICE)
    return found[0]


def _of_method(attributes: Attributes, role: str, after: type | None, alone: bool) -> Iterator[Found]:
    """Yields the info dicts that ``reset`` or ``step`` returns."""
    member, owner = attributes.find(role, after)
    if not isinstance(member, FunctionType) or hasattr(member, "__wrapped__") or owner in (gym.Env, gym.Wrapper):
        raise NotCompilable(f"{attributes.cls.__name__} has no ordinary method {role}", advice=f"define {role}")
    source = source_of(member)
    returned = list(returns_of(source.node))
    for node in returned:
        value = node.value
        if isinstance(value, ast.Tuple) and len(value.elts) == LENGTHS[role]:
            yield source, node, _info(attributes, source, value.elts[-1], node, alone)
        elif _is_super_call(value, role):
            yield from _of_method(attributes, role, owner, alone)
        else:
            what = "observation, info" if role == "reset" else "observation, reward, terminated, truncated, info"
            raise _refused(source, node, "the info dict is not written out here", f"return {what}")
    if not returned:
        raise _refused(source, source.node, f"{role} returns nothing", ADVICE)


def _info(
    attributes: Attributes, source: Source, node: ast.expr, returned: ast.Return, alone: bool, depth: int = 0
) -> Info:
    if isinstance(node, ast.Dict):
        if not node.keys:
            return None
        names = [key.value if isinstance(key, ast.Constant) else None for key in node.keys]
        if names == [KEY]:
            return node.values[0]
        if not alone and None not in names and names.count(KEY) < 2:
            return node.values[names.index(KEY)] if KEY in names else None
        other = next((one for one in names if one != KEY), KEY)
        shown = "items whose keys are computed" if other is None else repr(other)
        raise _refused(source, node, f"the info dict has {shown}, which compiled code leaves out", ADVICE)
    if isinstance(node, ast.Name):
        return _of_variable(attributes, source, node.id, returned, alone, depth)
    if isinstance(node, ast.Call) and depth < MOST_NESTED and not node.args and not node.keywords:
        function = node.func
        owner = function.value if isinstance(function, ast.Attribute) else None
        if isinstance(function, ast.Attribute) and isinstance(owner, ast.Name) and owner.id == own_name(source.node):
            return _of_helper(attributes, source, node, function.attr, alone, depth)
    raise _refused(source, node, "the info dict is not written out here", ADVICE)


def _of_variable(
    attributes: Attributes, source: Source, name: str, returned: ast.Return, alone: bool, depth: int
) -> Info:
    """Returns the info of a variable that is assigned dicts and returned, and not used otherwise."""
    assigned: list[ast.Assign | ast.AnnAssign] = []
    known: set[int] = set()
    for one in ast.walk(source.node):
        if isinstance(one, ast.AnnAssign) or (isinstance(one, ast.Assign) and len(one.targets) == 1):
            target = one.targets[0] if isinstance(one, ast.Assign) else one.target
            if isinstance(target, ast.Name) and target.id == name and one.value is not None:
                assigned.append(one)
                known.add(id(target))
        elif isinstance(one, ast.Return) and isinstance(one.value, ast.Tuple):
            known.add(id(one.value.elts[-1]))
    for one in ast.walk(source.node):
        if isinstance(one, ast.Name) and one.id == name and id(one) not in known:
            raise _refused(source, one, f"the info dict {name} is changed or used here", ADVICE)
    if not assigned:
        raise _refused(source, returned, f"the info dict {name} is not written out", ADVICE)
    dicts = [one.value for one in assigned if one.value is not None]
    found = [_info(attributes, source, one, returned, alone, depth + 1) for one in dicts]
    if any(info is not None for info in found) and not (len(found) == 1 and _precedes(source, assigned[0], returned)):
        advice = f"assign {name} once, directly before the return"
        raise _refused(source, assigned[0], "the action mask may change before the info dict is returned", advice)
    return found[0]


def _of_helper(attributes: Attributes, source: Source, node: ast.Call, name: str, alone: bool, depth: int) -> Info:
    """Returns the info that a method of the class returns."""
    member, _ = attributes.find(name)
    if not isinstance(member, FunctionType) or hasattr(member, "__wrapped__"):
        raise _refused(source, node, f"the info dict comes from {name}, which is no ordinary method", ADVICE)
    inner = source_of(member)
    returned = list(returns_of(inner.node))
    if not isinstance(inner.node.body[-1], ast.Return):
        raise _refused(inner, inner.node, f"{name} may return no info dict", ADVICE)
    infos = []
    for one in returned:
        if one.value is None:
            raise _refused(inner, one, f"{name} returns no info dict here", ADVICE)
        infos.append(_info(attributes, inner, one.value, one, alone, depth + 1))
    if len(infos) > 1 and any(info is not None for info in infos):
        raise _refused(inner, inner.node, f"{name} returns several info dicts", ADVICE)
    return infos[0]


def returns_of(node: ast.AST) -> Iterator[ast.Return]:
    """Yields the return statements of a function, not those of functions in it."""
    for one in ast.iter_child_nodes(node):
        if isinstance(one, ast.Return):
            yield one
        elif not isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda | ast.ClassDef):
            yield from returns_of(one)


def _precedes(source: Source, statement: ast.stmt, returned: ast.Return) -> bool:
    """Returns whether a statement stands directly before a return."""
    for one in ast.walk(source.node):
        for block in (getattr(one, name, None) for name in ("body", "orelse", "finalbody")):
            if isinstance(block, list) and returned in block and block.index(returned):
                return block[block.index(returned) - 1] is statement
    return False


def _is_super_call(node: ast.expr | None, role: str) -> bool:
    function = node.func if isinstance(node, ast.Call) else None
    is_method = isinstance(function, ast.Attribute) and function.attr == role
    return is_method and ast.unparse(function.value) == "super()"  # type: ignore[union-attr]


def _text(info: Info) -> str:
    return "" if info is None else ast.dump(info)


def _refused(source: Source, node: ast.AST, reason: str, advice: str) -> NotCompilable:
    return NotCompilable(reason, source.file, getattr(node, "lineno", source.node.lineno), advice)
