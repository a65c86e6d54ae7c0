"""Assignments to local variables, attributes and elements."""

import ast
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.expressions import containers
from qtab.compilation.rewriting.expressions.operators import SYMBOLS
from qtab.compilation.rewriting.library.builtin_functions import makes_iterator
from qtab.compilation.rewriting.statements.effects import check_pure
from qtab.compilation.rewriting.statements.info_counts import is_info_count
from qtab.compilation.rewriting.statements.left_out import note_attribute, note_change, note_kind, note_value, number
from qtab.compilation.rewriting.statements.references import is_new, is_owned, shared_names
from qtab.compilation.rewriting.statements.stores import changeable, store, store_element
from qtab.compilation.rewriting.statements.variables import in_variables, is_simple, kept
from qtab.compilation.rewriting.values import (
    FLOAT,
    INFO,
    MIXED,
    Array,
    DictKind,
    InfoKind,
    Scalar,
    TupleKind,
    Value,
    constant,
    in_words,
)

if TYPE_CHECKING:
    from qtab.compilation.rewriting.statements.statements import Statements


def assign(scope: "Statements", node: ast.stmt, targets: list[ast.expr], value_node: ast.expr) -> None:
    """Rewrites an assignment."""
    if all(_is_left_out(scope, target) for target in targets):
        check_pure(scope, value_node)
        for target in targets:
            if isinstance(target, ast.Attribute):
                note_value(scope, node, value_node)
                note_kind(
                    scope, target.attr, number(scope, value_node), len(targets) == 1 and is_new(scope, value_node)
                )
                note_attribute(scope, node, target.attr)
            elif isinstance(target, ast.Subscript):
                scope.program.changes_infos = True
            elif isinstance(target, ast.Name):
                scope.kinds[scope.version(target.id)] = INFO
                scope.note_set(target.id)
        return
    if not all(isinstance(target, ast.Tuple | ast.List) for target in targets):
        refuse_iterator(scope, value_node)
    scope.shared = {name for one in targets for name in shared_names(scope, one, value_node, len(targets) == 1)}
    scope.whole = value_node
    value = scope.expression(value_node)
    if value.is_fixed and scope.has_effects(value):
        scope.emit(value.code, node)
        value = constant(value.fixed)
    if specials.is_special(value.fixed) and not all(isinstance(target, ast.Name) for target in targets):
        raise specials.refused_special(scope, value_node, value)
    assign_value(scope, node, targets, value)


def refuse_iterator(scope: "Statements", node: ast.expr) -> None:
    """Refuses an iterator that is kept or returned, which compiled code could read twice."""
    if makes_iterator(scope, node):
        advice = f"write list({ast.unparse(node)})" if isinstance(node, ast.Call) else "write a list: [...]"
        raise scope.refuse(node, "an iterator, which can be read only once, is kept in a variable or returned,", advice)


def assign_value(scope: "Statements", node: ast.stmt, targets: "ast.expr | list[ast.expr]", value: Value) -> None:
    """Assigns a value to targets, and evaluates it once."""
    targets = targets if isinstance(targets, list) else [targets]
    several = len(targets) > 1 or isinstance(targets[0], ast.Tuple | ast.List)
    if several:
        _check_parts(scope, node, targets, value)
    if several and not value.is_fixed and not is_simple(value):
        value = in_variables(scope, node, value)
    if len(targets) > 1:
        value = replace(value, fresh=False)
    shown = value.views & {one.attr for target in targets for one in _changed(target)} if several else set()
    if shown:
        reason = f"a part of self.{min(shown)} is read, and changed before it is assigned,"
        raise scope.refuse(node, reason, "write .copy() after each part that is read")
    for target in targets:
        bind(scope, node, target, value)


def _check_parts(scope: "Statements", node: ast.stmt, targets: list[ast.expr], value: Value) -> None:
    """Refuses to read a part of a local array in an assignment to several targets, one of which changes it."""
    source = node.value if isinstance(node, ast.Assign) else None
    stored = [one for target in targets for one in ast.walk(target) if isinstance(one, ast.Subscript)]
    changed = {one.value.id for one in stored if isinstance(one.value, ast.Name)}
    read = {one.id for one in ast.walk(source) if isinstance(one, ast.Name)} if source is not None else set()
    if changed & read and _has_part(value):
        reason = f"a part of {min(changed & read)} is read, and changed before it is assigned,"
        raise scope.refuse(node, reason, "write .copy() after each part that is read")


def _has_part(value: Value) -> bool:
    """Returns whether a value is, or contains, an array that was not made by its expression."""
    if value.parts is not None:
        return any(map(_has_part, value.parts))
    kinds = value.kind.items if isinstance(value.kind, TupleKind) else [value.kind]
    return not value.fresh and any(isinstance(kind, Array) for kind in kinds)


def _changed(target: ast.expr) -> Iterator[ast.Attribute]:
    """Yields the attributes whose elements are assigned."""
    for one in ast.walk(target):
        if isinstance(one, ast.Subscript) and isinstance(one.ctx, ast.Store) and isinstance(one.value, ast.Attribute):
            yield one.value


def _is_left_out(scope: "Statements", target: ast.expr) -> bool:
    """Returns whether a target is an info dict, an element of one, or an attribute that is never read."""
    if isinstance(target, ast.Subscript) and isinstance(target.value, ast.Name):
        name = target.value.id
        return name in scope.infos or isinstance(scope.kind_of_local(name), InfoKind)
    if isinstance(target, ast.Name):
        return target.id in scope.infos
    return _is_unread(scope, target)


def _is_unread(scope: "Statements", target: ast.expr) -> bool:
    if isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name):
        base = scope.fixed.get(target.value.id)
        known = scope.program.attributes
        is_own = base is not None and base.fixed is specials.SELF
        has_setter = hasattr(type(known.find(target.attr)[0]), "__set__")
        return is_own and target.attr not in known.read and not has_setter
    return False


def bind(scope: "Statements", node: ast.stmt, target: ast.expr, value: Value) -> None:
    """Assigns a value to a target."""
    if isinstance(target, ast.Name):
        _bind_name(scope, node, target.id, value)
    elif isinstance(target, ast.Tuple | ast.List):
        _unpack(scope, node, target, value)
    elif isinstance(target, ast.Attribute):
        base = scope.expression(target.value)
        if base.fixed is not specials.SELF:
            raise scope.refuse(target, "an attribute of another object is assigned", "keep its numbers in self")
        store(scope, node, target.attr, value)
    elif isinstance(target, ast.Subscript):
        store_element(scope, node, target, value)
    else:
        raise scope.refuse(target, "this target of an assignment", "assign to names")


def _bind_name(scope: "Statements", node: ast.stmt, name: str, value: Value) -> None:
    scope.note_set(name)
    if name in scope.infos:
        if isinstance(value.kind, InfoKind | DictKind) or isinstance(value.fixed, dict):
            scope.kinds[scope.version(name)] = INFO
            return
        raise scope.refuse(node, "the info dict is made in another assignment", "assign it by itself")
    if value.kind == INFO:
        scope.kinds[scope.version(name)] = INFO
        return
    if scope.depth and scope.names.counts[name] > 1 and name not in scope.dynamic:
        scope.dynamic.add(name)
        scope.unstable = True
    if value.is_fixed and (name not in scope.dynamic or specials.is_special(value.fixed)):
        if name in scope.dynamic:
            raise specials.refused_special(scope, node, value)
        scope.fixed[name] = constant(value.fixed)
        return
    scope.fixed.pop(name, None)
    scope.actions.discard(name)
    if value.action:
        scope.actions.add(name)
    value = kept(scope.lift(value, node))
    scope.new_version(name, value.kind)
    scope.note_kind(name, value.kind, node)
    scope.mark_array(name, value)
    version = scope.version(name)
    scope.views[version] = scope.views.get(version, frozenset()) | value.views
    scope.note_alias(value, node)
    scope.emit(f"{scope.version(name)} = {value.code}", node)


def _unpack(scope: "Statements", node: ast.stmt, target: ast.Tuple | ast.List, value: Value) -> None:
    if any(isinstance(one, ast.Starred) for one in target.elts):
        raise scope.refuse(target, "a starred name", "name each element")
    if isinstance(value.kind, Array):
        scope.lift(value, node)
        value = in_variables(scope, node, containers.as_tuple(scope, node, value))
    parts = containers.elements(scope, node, value)
    if len(parts) != len(target.elts):
        raise scope.refuse(target, f"{len(parts)} values for {len(target.elts)} names", "correct the names")
    for one, part in zip(target.elts, parts, strict=True):
        bind(scope, node, one, part)


def augmented(scope: "Statements", node: ast.AugAssign) -> None:
    """Rewrites ``target += value`` and the like."""
    target = node.target
    if type(node.op) not in SYMBOLS:
        raise scope.refuse(node, "the matrix product may round differently", "write the sums as a loop")
    if isinstance(target, ast.Name):
        before = scope.expression(target)
        result = scope.combine(node, before, scope.expression(node.value), node.op)
        if isinstance(before.kind, Array):
            if not scope.is_owned(target.id) or scope.names.shared_before_change(target.id, before.kind.ndim):
                advice = "write x = x + y, which makes a new array"
                raise scope.refuse(node, f"{target.id} may share its memory with another array", advice)
            _check_in_place(scope, node, before, result)
        elif (isinstance(before.kind, TupleKind) or isinstance(before.fixed, list | dict | set)) and not is_owned(
            scope, target
        ):
            advice = f"write x = x {SYMBOLS[type(node.op)][0]} y, which makes a new object"
            raise scope.refuse(node, f"{target.id} may have another name, which would show the change,", advice)
        _bind_name(scope, node, target.id, result)
        return
    if _is_unread(scope, target):
        check_pure(scope, node.value)
        note_change(scope, node, target)  # type: ignore[arg-type]
        return
    if isinstance(target, ast.Attribute):
        before = scope.expression(target)
        result = scope.combine(node, before, scope.expression(node.value), node.op)
        if isinstance(before.kind, Array):
            _check_in_place(scope, node, before, result)
            scope.program.attributes.changed_in_place.add(target.attr)
        bind(scope, node, target, result)
        return
    if is_info_count(scope, node):
        return
    if isinstance(target.value, ast.Name) and target.value.id in scope.infos:
        advice = 'write info["x"] = ... with the new value'
        raise scope.refuse(node, "an element of an info dict is changed by an operator", advice)
    base = changeable(scope, node, target)
    if any(isinstance(one, ast.Call) for one in ast.walk(target.slice)):
        raise scope.refuse(node, "a call in the index of an element that is changed", "assign the index to a variable")
    load = ast.copy_location(ast.Subscript(target.value, target.slice, ast.Load()), target)
    if isinstance(base.kind, TupleKind):
        before = containers.subscript(scope, load)
    else:
        before = containers.element(scope, load, base)
    result = scope.combine(node, before, scope.expression(node.value), node.op)
    if isinstance(before.kind, Array):
        _check_in_place(scope, node, before, result)
    elif scalar_name(before) == "int" and isinstance(base.kind, Array) and result.kind in (FLOAT, MIXED):
        raise scope.refuse(node, "a float assigned to an element of an array of integers", "use an array of floats")
    store_element(scope, node, target, result)


def scalar_name(value: Value) -> str:
    """Returns the name of a number's kind; empty for others."""
    return value.kind.name if isinstance(value.kind, Scalar) else ""


def _check_in_place(scope: "Statements", node: ast.AST, before: Value, after: Value) -> None:
    shapes = before.kind.shape, after.kind.shape if isinstance(after.kind, Array) else None
    if after.kind.dtype == before.kind.dtype and None in shapes:
        advice = "write a loop over the elements"
        raise scope.refuse(node, "a part of an array whose size is not known is changed in place", advice)
    if after.kind.dtype != before.kind.dtype or shapes[0] != shapes[1]:
        advice = "write x = x + y"
        raise scope.refuse(node, f"{in_words(before.kind)} becomes {in_words(after.kind)} in place", advice)
