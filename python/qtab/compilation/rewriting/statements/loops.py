"""Loops: unrolled over constants, or kept."""

import ast
from typing import TYPE_CHECKING

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.expressions import containers, membership
from qtab.compilation.rewriting.program import converted
from qtab.compilation.rewriting.source.syntax import changed_attributes, leaves_loop
from qtab.compilation.rewriting.statements import assignments
from qtab.compilation.rewriting.statements.order import check_order
from qtab.compilation.rewriting.statements.variables import in_variables
from qtab.compilation.rewriting.values import INT, Array, TupleKind, Value, constant, in_words, scalar_of

if TYPE_CHECKING:
    from qtab.compilation.rewriting.statements.statements import Statements

MAX_UNROLLED = 32
"""The most rounds of a loop over a constant that are written one after the other."""


def while_loop(scope: "Statements", node: ast.While) -> bool:
    """Rewrites a while loop."""
    if node.orelse:
        raise scope.refuse(node, "while with else", "use a boolean variable")
    scope.depth += 1
    scope.copies_state = scope.may_change_state(node.test)
    test = scope.test(node.test)
    check_order(scope, node.test)
    scope.depth -= 1
    if test.is_fixed and not test.fixed:
        return False
    scope.emit(f"while {'True' if test.is_fixed else test.code}:", node)
    before = set(scope.flow.assigned)
    scope.flows_at_exit.append(([], []))
    scope.indented(node.body)
    breaks, _ = scope.flows_at_exit.pop()
    scope.flow.assigned = set.intersection(*breaks) if test.is_fixed and breaks else before
    return test.is_fixed and not leaves_loop(node.body)


def for_loop(scope: "Statements", node: ast.For) -> bool:
    """Rewrites a for loop."""
    if node.orelse:
        raise scope.refuse(node, "for with else", "use a boolean variable")
    if isinstance(node.iter, ast.Call) and isinstance(node.iter.func, ast.Name):
        function = scope.expression(node.iter.func).fixed
        if function is range:
            return _range(scope, node, node.iter)
        if function is enumerate and len(node.iter.args) == 1 and not node.iter.keywords:
            return _each(scope, node, scope.expression(node.iter.args[0]), True)
    return _each(scope, node, scope.expression(node.iter), False)


def _range(scope: "Statements", node: ast.For, call: ast.Call) -> bool:
    scope.copies_state = scope.may_change_state(call)
    values = [scope.lifted(one) for one in call.args]
    check_order(scope, call)
    if call.keywords or not 1 <= len(values) <= 3 or any(value.kind != INT for value in values):
        raise scope.refuse(call, "range with something other than integers", "write int(...)")
    if all(value.is_fixed for value in values):
        numbers = range(*[value.fixed for value in values])
        if not numbers:
            return False
    known = all(value.is_fixed for value in values)
    _head(scope, node, f"range({', '.join(value.code for value in values)})", Value(INT, ""), is_run=known)
    return False


def _head(
    scope: "Statements", node: ast.For, iterable: str, item: Value, before: str = "", is_run: bool = False
) -> None:
    """Writes a loop whose rounds are counted at run time.

    Args:
        scope: The function.
        node: The loop.
        iterable: The code of what is counted.
        item: The kind of the elements.
        before: The code that computes an element from ``i``.
        is_run: Whether there is at least one round.
    """
    scope.temporaries += 1
    name = f"i_{scope.temporaries}"
    scope.emit(f"for {name} in {iterable}:", node)
    scope.indent += 1
    scope.depth += 1
    scope.program.depth += 1
    for one in ast.walk(node.target):
        if isinstance(one, ast.Attribute | ast.Subscript):
            raise scope.refuse(node.target, "a loop that assigns to an attribute or an element", "use a local variable")
        if isinstance(one, ast.Name) and one.id not in scope.dynamic:
            scope.dynamic.add(one.id)
            scope.unstable = True
    before_loop = set(scope.flow.assigned)
    value = Value(item.kind, before.format(i=name) if before else name)
    assignments.assign_value(scope, node, node.target, value)
    constants = set(scope.fixed)
    scope.flows_at_exit.append(([], []))
    ended = scope.block(node.body)
    breaks, continues = scope.flows_at_exit.pop()
    ends = breaks + continues + ([] if ended else [scope.flow.assigned])
    scope.flow.assigned = set.intersection(*ends) if is_run and ends else before_loop
    for one_name in scope.fixed.keys() - constants:  # it is not set if the loop is not run
        del scope.fixed[one_name]
    scope.indent -= 1
    scope.depth -= 1
    scope.program.depth -= 1


def _each(scope: "Statements", node: ast.For, iterable: Value, counted: bool) -> bool:
    check_order(scope, node.iter)
    if iterable.views & changed_attributes(node.body):
        scope.note_alias(iterable, node.iter)
    before = len(scope.called)
    ended = _rounds(scope, node, iterable, counted)
    for function in scope.called[before:]:
        scope.note_alias(iterable, node.iter, function)
    return ended


def _rounds(scope: "Statements", node: ast.For, iterable: Value, counted: bool) -> bool:
    scope.copies_state = True
    if iterable.is_fixed and not specials.is_special(iterable.fixed):
        items = containers.elements(scope, node.iter, iterable)
    elif isinstance(iterable.kind, TupleKind):
        if not iterable.code.isidentifier():
            iterable = in_variables(scope, node, iterable)
        items = containers.elements(scope, node.iter, iterable)
    elif isinstance(iterable.kind, Array):
        return _array(scope, node, iterable, counted)
    else:
        raise scope.refuse(
            node.iter, f"a loop over {in_words(iterable.kind)}", "loop over a range, a tuple or an array"
        )
    if leaves_loop(node.body) or len(items) > MAX_UNROLLED:
        return _indexed(scope, node, items, counted)
    for i, item in enumerate(items):
        before = dict(scope.fixed)
        membership.bind_constant(scope, node.target, scope.tuple_of([constant(i), item], node) if counted else item)
        if scope.block(node.body):
            return True
        names = {one.id for one in ast.walk(node.target) if isinstance(one, ast.Name)}
        scope.fixed = {name: value for name, value in scope.fixed.items() if name not in names or name in before}
    return False


def _indexed(scope: "Statements", node: ast.For, items: list[Value], counted: bool) -> bool:
    """Writes a loop over a constant as a loop over the indices of its elements."""
    if not items:
        return False
    if not all(item.is_fixed for item in items):
        raise scope.refuse(node, "break or continue in a loop over values that change", "write a loop over an array")
    scope.temporaries += 1
    name = f"i_{scope.temporaries}"
    value = containers.lookup(scope, node.iter, [item.fixed for item in items], Value(INT, "{i}"))
    kind = TupleKind((INT, value.kind)) if counted else value.kind
    code = f"({{i}}, {value.code})" if counted else value.code
    _head(scope, node, f"range({len(items)})", Value(kind, name), code, is_run=True)
    return False


def _array(scope: "Statements", node: ast.For, iterable: Value, counted: bool) -> bool:
    if iterable.kind.ndim != 1:
        raise scope.refuse(node.iter, f"a loop over {in_words(iterable.kind)}", "loop over the indices with range")
    array = in_variables(scope, node, iterable)
    scalar = scalar_of(iterable.kind.dtype)
    element = converted(f"{array.code}[{{i}}]", scalar)
    kind = TupleKind((INT, scalar)) if counted else scalar
    code = f"({{i}}, {element})" if counted else element
    _head(scope, node, f"range({array.code}.shape[0])", Value(kind, ""), code)
    return False
