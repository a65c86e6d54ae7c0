"""Assignments to attributes of the environment, and to elements of its arrays and lists."""

import ast
from types import MemberDescriptorType
from typing import TYPE_CHECKING, Any

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.expressions import containers
from qtab.compilation.rewriting.library import arrays
from qtab.compilation.rewriting.statements.left_out import note_attribute, note_kind
from qtab.compilation.rewriting.statements.variables import in_variables, is_simple
from qtab.compilation.rewriting.values import (
    BOOL,
    FLOAT,
    INT,
    MIXED,
    Array,
    Scalar,
    TupleKind,
    Value,
    in_words,
    is_immutable,
    kind_of,
    scalar_of,
)

if TYPE_CHECKING:
    from qtab.compilation.rewriting.statements.statements import Statements

KEEP = "keep what changes in an array that is an attribute of the environment"


def store(scope: "Statements", node: ast.stmt, name: str, value: Value) -> None:
    """Assigns a value to an attribute of the environment."""
    known = scope.program.attributes
    member, _ = known.find(name)
    is_descriptor = hasattr(type(member), "__set__") and not isinstance(member, MemberDescriptorType)  # of a slot
    if is_descriptor or name in ("np_random", "_np_random", "observation_space", "action_space"):
        raise scope.refuse(node, f"self.{name} is assigned", "assign it in __init__ only, or use another attribute")
    known.note_assigned(name)
    if name not in known.read:
        note_attribute(scope, node, name)
        kind = kind_of(value.fixed) if value.is_fixed else value.kind
        note_kind(scope, name, kind, value.is_fixed and is_immutable(value.fixed))
        if scope.has_effects(value):
            scope.emit(value.code, node)
        return

    def refuse(reason: str, advice: str) -> Any:
        return scope.refuse(node, reason, advice)

    kind = known.kind(name, refuse)
    value = scope.lift(value, node)
    known.widen(name, value.kind, refuse)
    scope.compiled.changes = True
    scope.flow.assigned.add(name)
    scope.program.stored.add(name)
    can_change = isinstance(kind, Array) or isinstance(getattr(known.twin, name), list)
    is_new = value.fresh and not (isinstance(value.kind, Array) and value.views)
    may_share = value.parts is None or name in scope.shared or bool(value.views)
    has_inner = isinstance(kind, TupleKind) and bool(value.views)  # a list that an element of the tuple shows
    if (can_change and not is_new and may_share) or has_inner:
        reason, advice = f"self.{name} shares memory that is changed in place", "write .copy() where it is assigned"
        known.shared.append(({name, *value.views}, lambda: scope.refuse(node, reason, advice)))
    _store_field(scope, node, name, kind, value)


def _store_field(scope: "Statements", node: ast.stmt, field: str, kind: Any, value: Value) -> None:
    if isinstance(kind, TupleKind):
        if (value.parts is None and not is_simple(value)) or (value.parts and len(value.parts) > 1):
            value = in_variables(scope, node, value)
        for i, item in enumerate(kind.items):
            _store_field(scope, node, f"{field}.{i}", item, scope.element(value, i))
    elif isinstance(kind, Array):
        helper = {1: "h_store_vector", 2: "h_store_matrix"}.get(kind.ndim, "h_store")
        scope.compiled.uses.add(helper)
        scope.emit(f"{helper}(record[{field!r}], {value.code})", node)
    else:
        scope.emit(f"record[{field!r}] = {value.code}", node)


def store_element(scope: "Statements", node: ast.stmt, target: ast.Subscript, value: Value) -> None:
    """Assigns a value to an element or a part of an array, or to an element of a list of numbers."""
    base = changeable(scope, node, target)
    if isinstance(base.kind, TupleKind):
        _store_list_element(scope, node, target, base.kind, value)
        return
    code, left, shape = containers.array_index(scope, target, base.kind)
    value = scope.lift(value, node)
    if isinstance(value.kind, TupleKind) and left == 1:
        value = arrays.make(scope, node, value, base.kind.dtype)
    scalar = scalar_of(base.kind.dtype)
    source = base.raw or base.code
    if isinstance(value.kind, Array) and left:
        if value.kind.dtype != base.kind.dtype or None in (shape, value.kind.shape) or shape != value.kind.shape:
            advice = "assign an array of the same dtype and shape"
            raise scope.refuse(node, f"{in_words(value.kind)} assigned to a part of {in_words(base.kind)}", advice)
    elif not isinstance(value.kind, Scalar):
        raise scope.refuse(node, f"{in_words(value.kind)} assigned to an element", "assign a number")
    else:
        value = element_value(scope, node, scalar, value)
    scope.emit(f"{source}[{code}] = {value.code}", node)


def element_value(scope: "Statements", node: ast.stmt, scalar: Scalar, value: Value) -> Value:
    """Returns a number as it is stored in an array."""
    kind = value.kind
    if scalar == BOOL and kind == INT:
        return Value(BOOL, f"({value.code} != 0)")
    if kind == scalar or (scalar == FLOAT and kind in (INT, BOOL, MIXED)) or (scalar == INT and kind == BOOL):
        return value
    if scalar.name == "float32" and kind in (FLOAT, INT, MIXED):
        return value
    if scalar.name.startswith(("int", "uint")) and kind in (INT, BOOL):
        return Value(scalar, f"int({value.code})")
    raise scope.refuse(
        node, f"{in_words(kind)} assigned to an element of an array of {scalar.name}", "convert it first"
    )


def changeable(scope: "Statements", node: ast.stmt, target: ast.Subscript) -> Value:
    """Returns the array or list whose elements are assigned."""
    base = target.value
    if isinstance(base, ast.Attribute):
        owner = scope.expression(base.value)
        if owner.fixed is specials.SELF:
            known = scope.program.attributes
            known.note_assigned(base.attr)
            copies, scope.copies_state = scope.copies_state, False
            index = ast.unparse(target.slice)
            whole = ":" in index and set(index) <= set("(:, )") and not isinstance(node, ast.AugAssign)
            value = scope.load_state(base.attr, base, not whole)
            scope.program.stored.add(base.attr)
            if whole:
                scope.flow.assigned.add(base.attr)
            scope.copies_state = copies
            known.changed_in_place.add(base.attr)
            scope.compiled.changes = True
            if isinstance(value.kind, Array) or isinstance(getattr(known.twin, base.attr), list):
                return value
            raise scope.refuse(node, f"an element of {in_words(value.kind)} is assigned", "use a NumPy array")
    if isinstance(base, ast.Name) and base.id not in scope.fixed:
        value = scope.expression(base)
        if isinstance(value.kind, Array):
            if not scope.is_owned(base.id) or scope.names.shared_before_change(base.id, value.kind.ndim):
                advice = "write .copy() where the variable is assigned"
                raise scope.refuse(node, f"{base.id} may share its memory with another array", advice)
            return value
    if isinstance(base, ast.Subscript):
        raise scope.refuse(node, "an element of an element is assigned", "write one index: array[i, j]")
    raise scope.refuse(node, "an element is assigned of something other than an array of self", KEEP)


def _store_list_element(
    scope: "Statements", node: ast.stmt, target: ast.Subscript, kind: TupleKind, value: Value
) -> None:
    key = containers.index_value(scope, target.slice)
    if not isinstance(key.fixed, int):
        raise scope.refuse(node, "an element of a list at an index that is known at run time", "use a NumPy array")
    name = target.value.attr  # type: ignore[attr-defined]
    try:
        position = range(len(kind.items))[key.fixed]
    except IndexError:
        raise scope.refuse(node, f"there is no element {key.fixed}", "correct the index") from None
    value = scope.lift(value, node)
    items = tuple(value.kind if i == position else item for i, item in enumerate(kind.items))
    scope.program.attributes.widen(name, TupleKind(items), lambda reason, advice: scope.refuse(node, reason, advice))
    _store_field(scope, node, f"{name}.{position}", kind.items[position], value)
