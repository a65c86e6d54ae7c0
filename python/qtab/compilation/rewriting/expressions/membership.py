"""``in``, and comprehensions over constants."""

import ast
from typing import TYPE_CHECKING

import numpy as np

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.expressions.containers import MAX_CASES, elements
from qtab.compilation.rewriting.expressions.operators import comparison
from qtab.compilation.rewriting.source.syntax import calls_own_functions
from qtab.compilation.rewriting.values import BOOL, FLOAT, MIXED, Scalar, TupleKind, Value, constant, in_words

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

MAX_UNROLLED = 64
"""The most elements of a comprehension."""


def membership(scope: "Expressions", node: ast.AST, item: Value, container: Value, negated: bool) -> Value:
    """Returns the value of ``item in container``."""
    if container.is_fixed and not specials.is_special(container.fixed):
        if item.is_fixed:
            return scope.folded(
                node, lambda one, many: (one not in many) if negated else (one in many), item.fixed, container.fixed
            )
        if not isinstance(container.fixed, np.ndarray | str | bytes):
            choices = [scope.lift(constant(one), node) for one in container.fixed]
            return _is_one_of(scope, node, scope.lift(item, node), choices, negated)
    elif isinstance(container.kind, TupleKind) and container.parts is not None:
        return _is_one_of(scope, node, scope.lift(item, node), list(container.parts), negated, False)
    raise scope.refuse(node, f"`in` with {in_words(container.kind)}", "compare with == , or use np.any(... == x)")


def _is_one_of(
    scope: "Expressions", node: ast.AST, item: Value, choices: list[Value], negated: bool, constants: bool = True
) -> Value:
    fitting = [one for one in choices if _same_form(item, one)]
    if len(choices) > MAX_CASES:
        raise scope.refuse(node, f"`in` with {len(choices)} elements", "use a NumPy array of booleans")
    if len(fitting) < len(choices):
        raise scope.refuse(node, "`in` with elements of another type", "compare elements of one type")
    for one in choices:
        kind = comparison("==", item, one)
        if isinstance(kind, tuple) or kind != BOOL:
            raise scope.refuse(node, f"{in_words(item.kind)} == {in_words(one.kind)}", "compare numbers")
    name = scope.program.new_name("is_in")
    names = [one.code if constants else f"x{i}" for i, one in enumerate(choices)]
    # Tuples, since Python finds a NaN among elements that are the same object: the checks see the comparison of tuples.
    is_float = item.kind in (FLOAT, MIXED)
    tests = " or ".join(f"(key,) == ({code},)" if is_float else f"key == {code}" for code in names) or "False"
    parameters = "".join(f", {one}" for one in names) if not constants else ""
    scope.program.add(name, [f"def {name}(key{parameters}):", f"    return {tests}"])
    scope.compiled.uses.add(name)
    arguments = "".join(f", {one.code}" for one in choices) if not constants else ""
    code = f"{name}({item.code}{arguments})"
    return Value(BOOL, f"(not {code})" if negated else code)


def _same_form(item: Value, one: Value) -> bool:
    if isinstance(item.kind, TupleKind):
        return isinstance(one.kind, TupleKind) and len(item.kind.items) == len(one.kind.items)
    return isinstance(item.kind, Scalar) and isinstance(one.kind, Scalar)


def comprehension(scope: "Expressions", node: ast.ListComp | ast.GeneratorExp) -> list[Value]:
    """Returns the elements of a comprehension over a constant, or over a tuple."""
    if len(node.generators) != 1 or node.generators[0].is_async:
        raise scope.refuse(node, "a comprehension with several loops", "write the loops as statements")
    generator = node.generators[0]
    items = elements(scope, node, scope.expression(generator.iter))
    for item in items:
        scope.no_effects(item, generator.iter, "a call whose result may be used several times")
    if calls_own_functions(node.elt) and not all(item.is_fixed for item in items):
        raise scope.refuse(node, "a comprehension that calls functions with values that change", "write a loop")
    if len(items) > MAX_UNROLLED:
        raise scope.refuse(node, f"a comprehension over {len(items)} elements", "write a loop, or use NumPy")
    found: list[Value] = []
    for item in items:
        before = dict(scope.fixed)
        bind_constant(scope, generator.target, item)
        tests = [scope.test(one) for one in generator.ifs]
        if not all(test.is_fixed for test in tests):
            raise scope.refuse(node, "a comprehension with a condition that is known at run time", "write a loop")
        if all(test.fixed for test in tests):
            found.append(scope.expression(node.elt))
        scope.fixed.clear()
        scope.fixed.update(before)
    return found


def bind_constant(scope: "Expressions", target: ast.expr, value: Value) -> None:
    """Binds the names of an unrolled loop for one element."""
    if isinstance(target, ast.Name):
        scope.fixed[target.id] = value
    elif isinstance(target, ast.Tuple | ast.List):
        parts = elements(scope, target, value)
        if len(parts) != len(target.elts):
            raise scope.refuse(target, f"{len(parts)} values for {len(target.elts)} names", "correct the names")
        for one, part in zip(target.elts, parts, strict=True):
            bind_constant(scope, one, part)
    else:
        raise scope.refuse(target, "a loop that assigns to an attribute or an element", "use a local variable")
