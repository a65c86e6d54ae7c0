"""Expressions: each becomes a constant, or code with a kind."""

import ast
import builtins
import enum
import operator
from dataclasses import replace
from typing import Any

import numpy as np

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.expressions import calls, containers, members, membership, vectors
from qtab.compilation.rewriting.expressions.operators import COMPARISONS, SYMBOLS, binary, comparison, unary
from qtab.compilation.rewriting.program import converted, tuple_value
from qtab.compilation.rewriting.scope import Scope
from qtab.compilation.rewriting.values import (
    BOOL,
    Array,
    Scalar,
    TupleKind,
    Value,
    constant,
    in_words,
    join,
    own_operator,
)


class Expressions(Scope):
    """Rewrites expressions."""

    def expression(self, node: ast.expr) -> Value:
        """Returns the value of an expression."""
        value = self._evaluated(node)
        if isinstance(value.fixed, int | float | np.generic):
            self._no_own_operators(node, value.fixed)
        return value

    def _no_own_operators(self, node: ast.AST, *values: Any) -> None:
        """Refuses constants whose class defines operators, which compiled code would not call."""
        for value in values:
            name = own_operator(value)
            if name is not None:
                reason = f"{type(value).__name__} defines {name}, which compiled code does not call"
                advice = "write .value" if isinstance(value, enum.Enum) else "use int or float"
                raise self.refuse(node, reason, f"{advice}, or leave the method out")

    def _evaluated(self, node: ast.expr) -> Value:
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            names = {
                "JoinedStr": "an f-string",
                "Lambda": "a lambda",
                "NamedExpr": "an assignment within an expression",
            }
            name = names.get(type(node).__name__, f"{type(node).__name__}")
            advice = {"JoinedStr": "use numbers: strings cannot be compiled"}.get(type(node).__name__)
            raise self.refuse(node, f"{name} cannot be compiled", advice or "write it with statements and numbers")
        value: Value = method(node)
        if value.views and not isinstance(value.kind, Scalar):
            self.references.append((node, value.views))
        if value.is_fixed and node is not self.whole:  # its code would be left out
            self.no_effects(value, node)
        return value

    def lifted(self, node: ast.expr) -> Value:
        """Returns the value of an expression as code."""
        return self.lift(self.expression(node), node)

    def lift(self, value: Value, node: ast.AST) -> Value:
        """Returns a value as code."""
        return self.program.lift(value, lambda reason, advice: self.refuse(node, reason, advice))

    def scalar(self, node: ast.expr, what: str = "a number") -> Value:
        """Returns the value of an expression that must be a number."""
        value = self.lifted(node)
        if not isinstance(value.kind, Scalar):
            raise self.refuse(node, f"{in_words(value.kind)} where {what} is needed", "use a number")
        return value

    def test(self, node: ast.expr) -> Value:
        """Returns the value of a condition."""
        value = self._boolop(node, True) if isinstance(node, ast.BoolOp) else self.expression(node)
        if value.is_fixed and not specials.is_special(value.fixed):
            self._no_own_operators(node, value.fixed)
            try:
                return constant(bool(value.fixed))
            except ValueError:
                raise self.refuse(node, "the truth value of an array", "write .any() or .all()") from None
        value = self.lift(value, node)
        if not isinstance(value.kind, Scalar):
            advice = "write .any() or .all()" if isinstance(value.kind, Array) else "write a comparison"
            raise self.refuse(node, f"the truth value of {in_words(value.kind)}", advice)
        return value

    def _constant(self, node: ast.Constant) -> Value:
        return constant(node.value)

    def _name(self, node: ast.Name) -> Value:
        name = node.id
        if name in self.fixed:
            return self.fixed[name]
        if self.names.is_local(name):
            if self.kind_of_local(name) is None or not self.is_set(name):
                raise self.refuse(
                    node, f"the variable {name} may not be set yet", "set it before the branch or the loop"
                )
            return self.local(name)
        function = self.source.function
        free = function.__code__.co_freevars
        if name in free and function.__closure__:
            return constant(function.__closure__[free.index(name)].cell_contents)
        if name in function.__globals__:
            return constant(function.__globals__[name])
        if hasattr(builtins, name):
            return constant(getattr(builtins, name))
        raise self.refuse(node, f"the name {name} is not defined", "define it before the environment is trained")

    def _attribute(self, node: ast.Attribute) -> Value:
        return self.attribute_of(node, self._evaluated(node.value))

    def attribute_of(self, node: ast.Attribute, base: Value) -> Value:
        """Returns an attribute of a value."""
        return members.attribute(self, node, base)

    def arguments(self, node: ast.Call) -> tuple[list[Value], dict[str, Value]]:
        """Returns the arguments of a call: those without and those with names."""
        return calls.arguments(self, node)

    def _subscript(self, node: ast.Subscript) -> Value:
        return containers.subscript(self, node)

    def _binop(self, node: ast.BinOp) -> Value:
        left, right = self.expression(node.left), self.expression(node.right)
        return self.combine(node, left, right, node.op)

    def combine(self, node: ast.AST, left: Value, right: Value, op: ast.operator) -> Value:
        """Returns the result of an operator."""
        if type(op) not in SYMBOLS:
            raise self.refuse(node, "the matrix product may round differently", "write the sums as a loop")
        symbol, function = SYMBOLS[type(op)]
        if left.is_fixed and right.is_fixed:
            return self.folded(node, function, left.fixed, right.fixed)
        left, right = self.lift(left, node), self.lift(right, node)
        kind = self.kind(node, binary(symbol, left, right))
        parts = left.parts + right.parts if left.parts and right.parts and isinstance(kind, TupleKind) else None
        if parts:
            return tuple_value(parts)
        code = vectors.code(self, symbol, left, right, kind) or f"({left.code} {symbol} {right.code})"
        return Value(kind, code, fresh=True)

    def kind(self, node: ast.AST, result: Any) -> Any:
        """Returns the kind of the result of an operator; raises the reason and the advice given instead of one."""
        if isinstance(result, tuple):
            raise self.refuse(node, *result)
        return result

    def folded(self, node: ast.AST, function: Any, *values: Any) -> Value:
        """Returns the result of a function of constants."""
        self._no_own_operators(node, *values)
        try:
            return constant(function(*values))
        except Exception as error:
            raise self.refuse(node, f"this raises {type(error).__name__}: {error}", "correct the expression") from None

    def _unaryop(self, node: ast.UnaryOp) -> Value:
        if isinstance(node.op, ast.Not):
            value = self.test(node.operand)
            return constant(not value.fixed) if value.is_fixed else Value(BOOL, f"(not {value.code})")
        symbol = {ast.USub: "-", ast.UAdd: "+", ast.Invert: "~"}[type(node.op)]
        value = self.expression(node.operand)
        if value.is_fixed:
            named = {"-": operator.neg, "+": operator.pos, "~": operator.invert}
            return self.folded(node, named[symbol], value.fixed)
        kind = self.kind(node, unary(symbol, value))
        return Value(kind, f"({symbol}{value.code})", fresh=True)

    def _boolop(self, node: ast.BoolOp, is_test: bool = False) -> Value:
        is_and = isinstance(node.op, ast.And)
        parts: list[Value] = []
        for i, one in enumerate(node.values):
            assigned = set(self.flow.assigned)
            value = self.expression(one)
            if i:  # it may be left out
                self.flow.assigned = assigned
            if value.is_fixed and not specials.is_special(value.fixed):
                holds = self.test(one).fixed
                if holds != is_and or i == len(node.values) - 1:
                    if not parts:
                        return value
                    if holds != is_and or not isinstance(value.fixed, bool):
                        value = self.lift(value, one)
                        parts.append(value)
                    break
                continue
            if not parts and i == len(node.values) - 1 and not is_test:
                return value
            assigned = set(self.flow.assigned)
            parts.append(self.test(one))
            if i:
                self.flow.assigned = assigned
        if is_test:
            parts = [part if part.kind == BOOL else Value(BOOL, f"({part.code} != 0)") for part in parts]
        if len(parts) == 1:
            return parts[0]
        if any(part.kind != BOOL for part in parts):
            raise self.refuse(node, "and/or with something other than booleans", "write comparisons, such as x != 0")
        symbol = " and " if is_and else " or "
        return Value(BOOL, "(" + symbol.join(part.code for part in parts) + ")")

    def _compare(self, node: ast.Compare) -> Value:
        operands = [self.expression(one) for one in (node.left, *node.comparators)]
        if len(node.ops) > 1:
            if all(value.is_fixed for value in operands) or all(type(op) in COMPARISONS for op in node.ops):
                return self._chain(node, operands)
            raise self.refuse(node, "a chain of comparisons", "write two comparisons with `and`")
        return self._compared(node, node.ops[0], operands[0], operands[1])

    def _compared(self, node: ast.Compare, op: ast.cmpop, left: Value, right: Value) -> Value:
        if isinstance(op, ast.In | ast.NotIn):
            return membership.membership(self, node, left, right, isinstance(op, ast.NotIn))
        if isinstance(op, ast.Is | ast.IsNot):
            same = self._identical(node, left, right)
            return constant(same if isinstance(op, ast.Is) else not same)
        symbol, function = COMPARISONS[type(op)]
        if left.is_fixed and right.is_fixed:
            if specials.is_special(left.fixed) or specials.is_special(right.fixed):
                raise specials.refused_special(self, node, left if specials.is_special(left.fixed) else right)
            return self.folded(node, function, left.fixed, right.fixed)
        left, right = self.lift(left, node), self.lift(right, node)
        kind = self.kind(node, comparison(symbol, left, right))
        code = vectors.code(self, symbol, left, right, kind) or f"({left.code} {symbol} {right.code})"
        return Value(kind, code, fresh=True)

    def _chain(self, node: ast.Compare, operands: list[Value]) -> Value:
        lifted = [self.lift(value, node) for value in operands]
        text = lifted[0].code
        for op, left, right in zip(node.ops, lifted, lifted[1:], strict=False):
            symbol = COMPARISONS[type(op)][0]
            if self.kind(node, comparison(symbol, left, right)) != BOOL:
                raise self.refuse(node, "a chain of comparisons of arrays", "write two comparisons with &")
            text += f" {symbol} {right.code}"
        return Value(BOOL, f"({text})")

    def _identical(self, node: ast.Compare, left: Value, right: Value) -> bool:
        if left.is_fixed and right.is_fixed:
            if specials.is_special(left.fixed) or specials.is_special(right.fixed):
                raise specials.refused_special(self, node, left if specials.is_special(left.fixed) else right)
            if left.fixed is None or right.fixed is None or isinstance(left.fixed, bool | enum.Enum):
                return left.fixed is right.fixed
        elif any(value.is_fixed and value.fixed is None for value in (left, right)):
            self.no_effects(left, node)
            self.no_effects(right, node)
            return False
        raise self.refuse(node, "`is` compares objects", "write ==")

    def _ifexp(self, node: ast.IfExp) -> Value:
        test = self.test(node.test)
        if test.is_fixed:
            return self.expression(node.body if test.fixed else node.orelse)
        assigned = set(self.flow.assigned)
        one, other = self.lifted(node.body), self.lifted(node.orelse)
        self.flow.assigned = assigned
        kind = join(one.kind, other.kind)
        if kind is None:
            reason = f"{in_words(one.kind)} in one case, {in_words(other.kind)} in the other"
            raise self.refuse(node, reason, "use the same type in both")
        code = f"({one.code} if {test.code} else {other.code})"
        return Value(kind, code, views=one.views | other.views)

    def _call(self, node: ast.Call) -> Value:
        return calls.call(self, node)

    def load_state(self, name: str, node: ast.AST, is_read: bool = True) -> Value:
        """Returns an attribute that is in the record; ``is_read`` is False if all of it is assigned."""
        self.program.attributes.note_read(name)
        if is_read:
            self.flow.note_read(name)
        kind = self.program.attributes.kind(name, lambda reason, advice: self.refuse(node, reason, advice))
        value = self._loaded(name, kind)
        shared = isinstance(kind, Array) or isinstance(getattr(self.program.attributes.twin, name), list)
        return replace(value, views=frozenset([name])) if shared else value

    def _loaded(self, field: str, kind: Any) -> Value:
        if isinstance(kind, TupleKind):
            return tuple_value(tuple(self._loaded(f"{field}.{i}", item) for i, item in enumerate(kind.items)))
        code = f"record[{field!r}]"
        if isinstance(kind, Array):
            if kind.dtype == "bool":
                return Value(kind, f"({code} != 0)", raw=code)
            return Value(kind, f"{code}.copy()") if self.copies_state else Value(kind, code)
        return Value(kind, converted(code, kind))

    def tuple_of(self, parts: list[Value], node: ast.AST, made: Any = tuple) -> Value:
        """Returns a tuple of values."""
        if all(part.is_fixed for part in parts):
            return constant(made(part.fixed for part in parts))
        return tuple_value(tuple(self.lift(part, node) for part in parts))
