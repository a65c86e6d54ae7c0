"""The action mask, from the method ``action_masks()`` or from the info dict."""

import ast
from types import FunctionType
from typing import Any

import numpy as np

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.infos.dicts import KEY, info_of
from qtab.compilation.rewriting.program import Compiled, Program
from qtab.compilation.rewriting.source.sources import source_of
from qtab.compilation.rewriting.statements.effects import effect_of
from qtab.compilation.rewriting.statements.statements import Statements
from qtab.compilation.rewriting.user_functions import compiled_function
from qtab.compilation.rewriting.values import Array, Value, constant, in_words


def add_action_mask(program: Program) -> bool:
    """Adds the function ``action_mask(record)``; returns False for a class without masks.

    Raises:
        NotCompilable: if the class has masks that are not a function of its attributes.
    """
    program.phase = "mask"
    member, owner = program.attributes.find("action_masks")
    if isinstance(member, FunctionType):
        method = compiled_function(program, source_of(member), owner, {_self_name(member): constant(specials.SELF)})
        _add(program, f"{method.name}(record)", method.result, {method.name}, method)
        return True
    advice = "write a method action_masks(self)"
    try:
        _, first, mask = info_of(program.attributes, alone=False)
    except NotCompilable as refusal:
        reason = f"the action mask is not found in the info dicts: {refusal.reason}"
        raise NotCompilable(reason, refusal.file, refusal.line, advice) from None
    if mask is None:
        return False
    for infos in program.infos.values():
        for scope, node in infos:
            _check_later_effects(scope, node)
    found = {role: _mask_of(scope, node) for role, infos in program.infos.items() for scope, node in infos}
    expressions = {role: mask for role, mask in found.items() if mask is not None}
    if not expressions:
        line = getattr(first, "lineno", None)
        raise NotCompilable("the action mask is not found in the info dicts", None, line, advice)
    scope, node = next(iter(expressions.values()))
    if len({ast.dump(mask) for _, mask in expressions.values()}) > 1 or set(expressions) != {"reset", "step"}:
        raise scope.refuse(node, "the action masks of reset and step are not the same expression", advice)
    own = next(iter(scope.parameters))
    if any(isinstance(one, ast.Name) and one.id in scope.names.counts and one.id != own for one in ast.walk(node)):
        raise scope.refuse(node, "the action mask in the info dict depends on local variables", advice)
    compiled = program.named[program.new_name("mask")]
    compiled.file = scope.source.file
    inner = Statements(program, scope.source, scope.owner, {own: constant(specials.SELF)}, compiled, "mask")
    inner.fixed, inner.returns = {own: constant(specials.SELF)}, []
    value = inner.lifted(node)
    if compiled.changes or compiled.draws:
        raise scope.refuse(node, "the action mask changes the state", advice)
    code = value.code if value.fresh or value.raw else f"{value.code}.copy()"
    compiled.lines = [(f"def {compiled.name}(record):", node.lineno), (f"    return {code}", node.lineno)]
    _add(program, f"{compiled.name}(record)", value, {compiled.name}, compiled)
    program.mask = program.mask[0], node
    return True


def _check_later_effects(scope: Any, node: ast.expr) -> None:
    """Refuses an info dict in a variable if what is returned with it changes the state that its mask shows."""
    if isinstance(node, ast.Name):
        for one in ast.walk(scope.source.node):
            if isinstance(one, ast.Return) and isinstance(one.value, ast.Tuple) and one.value.elts[-1] is node:
                effect = effect_of(scope, one.value)
                if effect is not None:
                    reason = f"the action mask is computed before the return, in which {effect},"
                    raise scope.refuse(one, reason, "write a method action_masks(self)")


def _self_name(function: FunctionType) -> str:
    return function.__code__.co_varnames[0]


def _add(program: Program, code: str, result: Value, uses: set[str], compiled: Compiled) -> None:
    kind: Any = result.kind
    count = int(program.env.action_space.n)  # type: ignore[attr-defined]
    is_array = isinstance(kind, Array) and np.dtype(kind.dtype).kind in "biu"
    if not is_array or kind.shape not in (None, (count,)) or kind.ndim != 1:
        reason = f"the action mask is {in_words(kind) if kind is not None else 'not an array'}"
        raise NotCompilable(reason, compiled.file, compiled.lines[0][1], f"return an array of {count} booleans")
    if compiled.changes:
        advice = "compute the mask without changing attributes"
        raise NotCompilable("the action mask changes the state", compiled.file, compiled.lines[0][1], advice)
    program.mask = kind.dtype, None
    program.named["action_mask"] = Compiled(
        "action_mask", Value(), [("def action_mask(record):", 0), (f"    return {code}", 0)], uses=uses
    )


def _assigned(node: ast.AST, name: str) -> ast.expr | None:
    """Returns the info dict that a statement assigns to a variable; a dict with the mask for ``info[KEY] = mask``."""
    if not isinstance(node, ast.Assign) or len(node.targets) != 1:
        return None
    target = node.targets[0]
    if isinstance(target, ast.Name) and target.id == name:
        return None if isinstance(node.value, ast.Dict) and not node.value.keys else node.value
    is_element = isinstance(target, ast.Subscript) and isinstance(target.value, ast.Name) and target.value.id == name
    key = target.slice if is_element else None  # type: ignore[attr-defined]
    if isinstance(key, ast.Constant) and key.value == KEY:
        return ast.copy_location(ast.Dict([key], [node.value]), node)
    return None


def _mask_of(scope: Any, node: ast.expr, depth: int = 0) -> Any:
    """Returns the expression of the action mask in an info dict, with its scope; None if there is none."""
    if isinstance(node, ast.Dict):
        for key, value in zip(node.keys, node.values, strict=True):
            if isinstance(key, ast.Constant) and key.value == KEY:
                return scope, value
        return None
    if isinstance(node, ast.Name) and depth < 3:
        found = [_assigned(one, node.id) for one in ast.walk(scope.source.node)]
        made = [one for one in found if one is not None]
        if len(made) == 1:
            return _mask_of(scope, made[0], depth + 1)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and depth < 3:
        member, owner = scope.program.attributes.find(node.func.attr)
        if isinstance(member, FunctionType) and isinstance(node.func.value, ast.Name):
            source = source_of(member)
            compiled = Compiled("info", Value(), file=source.file)
            parameters = {_self_name(member): constant(specials.SELF)}
            inner = Statements(scope.program, source, owner, parameters, compiled, "")
            returned = [one.value for one in ast.walk(source.node) if isinstance(one, ast.Return)]
            if len(returned) == 1 and returned[0] is not None:
                return _mask_of(inner, returned[0], depth + 1)
            node = source.node  # type: ignore[assignment]
    if any(isinstance(one, ast.Constant) and one.value == KEY for one in ast.walk(scope.source.node)):
        advice = "write a method action_masks(self)"
        raise scope.refuse(node, "the action mask in the info dict is not found in a dict that is written out", advice)
    return None
