"""Checks where Python raises errors, and refusals where bits can differ, in the code of users' functions."""

import linecache
import math
import operator
import random
from typing import Any

import numpy as np
from numba.core import ir, types

from qtab.compilation.checks.checked_operations import (
    DRAW_CHECKS,
    INPLACE,
    INTEGER_OPERATIONS,
    MATH,
    RANGE_CHECKS,
    exact_integer,
    rounded,
    to_int,
)
from qtab.compilation.checks.number_types import NUMBERS, is_narrow, leaf, mixed, of_integers
from qtab.compilation.checks.refused_names import MATH_ADVICE, NUMPY_REFUSED, SUMS_REFUSED, WRITES_REFUSED
from qtab.compilation.checks.source_constructs import DRAWS_REFUSED
from qtab.compilation.not_compilable import NotCompilable

refusals: list[NotCompilable] = []
"""The constructs that the compilation in progress has met and that are refused."""

COMPARISONS = (operator.lt, operator.le, operator.gt, operator.ge, operator.eq, operator.ne)


class Checks:
    """The changes to the code of one function, whose types are known."""

    def __init__(self, state: Any) -> None:
        self.state, self.typemap, self.calltypes = state, state.typemap, state.calltypes
        self.definitions: dict[str, Any] = {}
        self.made = 0

    def run(self) -> bool:
        """Changes the code; returns whether there were changes."""
        blocks = self.state.func_ir.blocks
        for block in blocks.values():
            for statement in block.body:
                if isinstance(statement, ir.Assign):
                    self.definitions[statement.target.name] = statement.value
        for block in blocks.values():
            body: list[Any] = []
            for statement in block.body:
                if isinstance(statement, ir.Assign) and isinstance(statement.value, ir.Expr):
                    body += self._expression(statement, block.scope)
                elif isinstance(statement, ir.Assign) and isinstance(statement.value, ir.Var):
                    self._widening(statement, [statement.value])
                elif isinstance(statement, ir.SetItem | ir.StaticSetItem):
                    body += self._store(statement, block.scope)
                body.append(statement)
            block.body = body
        return self.made > 0

    def _store(self, statement: Any, scope: Any) -> list[Any]:
        of, value = self._type(statement.target), types.unliteral(self._type(statement.value))
        if isinstance(of, types.NumpyFlatType) and not of.array_type.mutable:
            self._refuse(statement, "array.flat changes an array of self", "copy the array first")
        elif isinstance(of, types.Array) and is_narrow(of.dtype) and isinstance(value, types.Integer):
            return self._check(RANGE_CHECKS[of.dtype], scope, [statement.value], statement.loc)
        return []

    def _widening(self, statement: Any, sources: list[Any]) -> None:
        """Refuses a number whose type is another one in Python, where it comes from another branch."""
        kinds = [leaf(self._type(source)) for source in sources]
        target = leaf(self._type(statement.target))
        if any((is_narrow(kind) or kind == types.float32) and kind != target for kind in kinds):
            self._refuse(statement, "numbers of several types", "convert them with np.int64(...) or np.float64(...)")

    def _expression(self, statement: Any, scope: Any) -> list[Any]:
        expression = statement.value
        if expression.op in ("binop", "inplace_binop"):
            return self._operation(statement, scope)
        if expression.op == "call":
            return self._call(statement, scope)
        if expression.op == "phi":
            self._widening(statement, [one for one in expression.incoming_values if isinstance(one, ir.Var)])
        if expression.op == "cast":
            self._widening(statement, [expression.value])
        if expression.op == "unary" and expression.fn is not operator.not_:
            of = types.unliteral(self._type(expression.value))
            if isinstance(of, types.Boolean):
                self._refuse(expression, "arithmetic of booleans", "write not x, or convert it with int(...)")
            elif is_narrow(leaf(of)):
                self._refuse(expression, mixed([leaf(of)]), "convert it with np.int64(...)")
        return []

    def _operation(self, statement: Any, scope: Any) -> list[Any]:
        expression = statement.value
        function = INPLACE.get(expression.fn, expression.fn)
        given = [self._type(expression.lhs), self._type(expression.rhs)]
        kinds = [leaf(one) for one in given]
        if not all(isinstance(kind, NUMBERS) for kind in kinds):
            return []
        if function is operator.matmul:
            return self._refuse(expression, "a matrix product may add in another order", "add in a loop")
        if function not in INTEGER_OPERATIONS and function not in COMPARISONS:
            return []
        if function in COMPARISONS and all(is_narrow(kind) <= (kind != types.uint64) for kind in kinds):
            kinds = [kind for kind in kinds if not is_narrow(kind)]  # which are compared exactly
        if reason := mixed(kinds):
            return self._refuse(expression, reason, "convert the numbers with np.int64(...) or np.float64(...)")
        scalars = not any(isinstance(one, types.Array) for one in given)
        integers = scalars and all(isinstance(kind, types.Integer | types.Boolean) for kind in kinds)
        if function is operator.pow:
            exponent = getattr(given[1], "literal_value", None)
            if not integers or not isinstance(exponent, int) or not 0 <= exponent <= 64:
                self._refuse(expression, "a power can differ in the last bit", "write products: x * x for x ** 2")
                return []
        if function in COMPARISONS:
            return self._comparison(expression, scope, kinds) if scalars else []
        if all(isinstance(kind, types.Boolean) for kind in kinds):
            if scalars and self._compares_action(expression.lhs) and self._compares_action(expression.rhs):
                return self._replace(
                    statement, scope, INTEGER_OPERATIONS[function], [expression.lhs, expression.rhs], [types.int64] * 2
                )
            # Those of NumPy are not added as those of Python are, and have the same type here.
            self._refuse(expression, "arithmetic of booleans", "convert them with int(...)")
            return []
        if not integers:
            return []
        helper = INTEGER_OPERATIONS[function]
        return self._replace(statement, scope, helper, [expression.lhs, expression.rhs], [types.int64] * 2)

    def _comparison(self, expression: Any, scope: Any, kinds: list[Any]) -> list[Any]:
        """Returns the check of an integer that is compared with a float, which compiled code rounds."""
        for kind, other, side in zip(kinds, reversed(kinds), (expression.lhs, expression.rhs), strict=False):
            if isinstance(kind, types.Integer) and isinstance(other, types.Float):
                return self._check(exact_integer, scope, [side], expression.loc)
        return []

    def _compares_action(self, variable: Any) -> bool:
        """Returns whether a variable is a comparison of the action with a constant, which is a boolean of Python."""
        found = self._definition(variable)
        if not isinstance(found, ir.Expr) or found.op != "binop" or found.fn not in COMPARISONS:
            return False
        sides = [self._definition(side) for side in (found.lhs, found.rhs)]
        return all(isinstance(one, ir.Const) or (isinstance(one, ir.Arg) and one.name == "action") for one in sides)

    def _definition(self, value: Any) -> Any:
        while isinstance(value, ir.Var):
            value = self.definitions.get(value.name)
        return value

    def _call(self, statement: Any, scope: Any) -> list[Any]:
        expression = statement.value
        function = self.typemap[expression.func.name]
        given = [self._type(one) for one in expression.args]
        if isinstance(function, types.BoundFunction):
            return self._method_call(statement, scope, given)
        if isinstance(function, types.NumberClass):
            if function.instance_type == types.int64 and given and isinstance(types.unliteral(given[0]), types.Float):
                return self._replace(statement, scope, to_int, expression.args, [types.float64])
            if is_narrow(function.instance_type) and given and isinstance(types.unliteral(given[0]), types.Integer):
                return self._check_before(expression, scope, RANGE_CHECKS[function.instance_type])
            return []
        if not isinstance(function, types.Function):
            return []
        key = function.typing_key
        defined = self.definitions.get(expression.func.name)
        called = getattr(defined, "value", None) if isinstance(defined, ir.Global | ir.FreeVar) else None
        name = str(getattr(key, "__name__", key)).rpartition(".")[2]
        if any(map(_draws_elsewhere, (key, called))):
            self._refuse(expression, f"{name} does not draw from the generator of the environment", "draw from rng")
        elif key in (int, float, round, sum, pow, divmod, min, max, abs):
            return self._builtin_call(statement, scope, key, given)
        elif getattr(key, "__module__", None) == "math" or getattr(math, name, None) is key:
            return self._math_call(statement, scope, key, name)
        elif isinstance(key, np.ufunc) or str(getattr(key, "__module__", "")).partition(".")[0] == "numpy":
            self._numpy_call(expression, key, name, given)
        return []

    def _builtin_call(self, statement: Any, scope: Any, key: Any, given: list[Any]) -> list[Any]:
        expression = statement.value
        kinds = [types.unliteral(one) for one in given]
        if key is round and len(given) > 1:
            self._refuse(expression, "round with digits can differ", "write math.floor(x + 0.5)")
        elif key in (pow, divmod):
            self._refuse(expression, f"{key.__name__} can differ", "write products, or a // b and a % b")
        elif key in (min, max, abs) and (reason := mixed([leaf(kind) for kind in kinds])):
            self._refuse(expression, reason, "convert the numbers with np.int64(...) or np.float64(...)")
        elif key is sum and not of_integers(kinds[0]):
            self._refuse(expression, "a sum of floats may be added in another order", "add in a loop")
        elif key in (int, round) and len(kinds) == 1 and isinstance(kinds[0], types.Float):
            return self._replace(statement, scope, to_int if key is int else rounded, expression.args, [types.float64])
        return []

    def _math_call(self, statement: Any, scope: Any, key: Any, name: str) -> list[Any]:
        expression = statement.value
        if key is math.gcd:
            return []
        if key not in MATH:
            advice = MATH_ADVICE.get(name, "use sin, cos, tan, exp, log, sqrt, floor, ceil or their like")
            return self._refuse(expression, f"math.{name} may round differently in compiled code", advice)
        return self._replace(statement, scope, MATH[key], expression.args, None)

    def _numpy_call(self, expression: Any, key: Any, name: str, given: list[Any]) -> None:
        kinds = [kind for kind in map(leaf, given) if isinstance(kind, NUMBERS)]
        if name in NUMPY_REFUSED:
            self._refuse(expression, f"np.{name} rounds differently in compiled code", NUMPY_REFUSED[name])
        elif name in WRITES_REFUSED:
            self._refuse(expression, f"np.{name} can change an array of self", "assign to the elements in a loop")
        elif name in SUMS_REFUSED and not (given and of_integers(given[0])):
            self._refuse(expression, f"np.{name} may add in another order", "add in a loop")
        elif isinstance(key, np.ufunc):
            if len(given) > key.nin:
                self._refuse(expression, f"np.{name} with an array for the result", "assign the result")
            elif reason := mixed(kinds):
                advice = "convert the numbers with np.int64(...) or np.float64(...)"
                self._refuse(expression, f"np.{name}: {reason}", advice)

    def _method_call(self, statement: Any, scope: Any, given: list[Any]) -> list[Any]:
        expression = statement.value
        defined = self.definitions.get(expression.func.name)
        if not isinstance(defined, ir.Expr) or defined.op != "getattr":
            return []
        of, name = self._type(defined.value), defined.attr
        if isinstance(of, types.NumPyRandomGeneratorType):
            if name in DRAWS_REFUSED:
                self._refuse(expression, f"{name} can draw other numbers", "draw from another distribution")
            elif name == "shuffle" and not getattr(given[0], "mutable", True):
                self._refuse(expression, "shuffle changes an array of self", "copy the array first")
            elif name in DRAW_CHECKS:
                return self._check_before(expression, scope, DRAW_CHECKS[name])
        elif isinstance(of, types.Array):
            if name in SUMS_REFUSED and not of_integers(of):
                self._refuse(expression, f"array.{name}() may add in another order", "add in a loop")
            elif name in ("sort", "fill", "partition", "put", "itemset") and not of.mutable:
                self._refuse(expression, f"array.{name}() changes an array of self", "copy the array first")
        return []

    def _type(self, variable: Any) -> Any:
        return self.typemap[variable.name]

    def _refuse(self, expression: Any, reason: str, advice: str) -> list[Any]:
        file, line = expression.loc.filename, expression.loc.line
        source = linecache.getline(file, line).strip()
        refusals.append(NotCompilable(f"{reason}, in `{source[:80]}`", file, line, advice))
        return []

    def _replace(
        self, statement: Any, scope: Any, helper: Any, arguments: list[Any], of: list[Any] | None
    ) -> list[Any]:
        """Replaces an expression by a call of a helper; returns the statement that defines the helper."""
        kinds = of or [types.unliteral(self._type(one)) for one in arguments]
        define, call = self._call_of(helper, scope, list(arguments), (), tuple(kinds), {}, statement.value.loc)
        statement.value = call
        return [define]

    def _check_before(self, expression: Any, scope: Any, helper: Any) -> list[Any]:
        """Returns the statements that call a helper with the arguments of a call."""
        kinds = tuple(types.unliteral(self._type(one)) for one in expression.args)
        named = {name: types.unliteral(self._type(one)) for name, one in expression.kws}
        define, call = self._call_of(
            helper, scope, list(expression.args), tuple(expression.kws), kinds, named, expression.loc
        )
        return [define, ir.Assign(call, self._variable(scope, types.none, expression.loc), expression.loc)]

    def _check(self, helper: Any, scope: Any, arguments: list[Any], loc: Any) -> list[Any]:
        """Returns the statements that call a helper."""
        kinds = tuple(types.unliteral(self._type(one)) for one in arguments)
        define, call = self._call_of(helper, scope, arguments, (), kinds, {}, loc)
        return [define, ir.Assign(call, self._variable(scope, types.none, loc), loc)]

    def _call_of(
        self, helper: Any, scope: Any, arguments: list[Any], named: Any, kinds: Any, named_kinds: Any, loc: Any
    ) -> tuple[Any, Any]:
        of = types.Dispatcher(helper)
        variable = self._variable(scope, of, loc)
        call = ir.Expr.call(variable, arguments, named, loc)
        self.calltypes[call] = of.get_call_type(self.state.typingctx, kinds, named_kinds)
        return ir.Assign(ir.Global(variable.name, helper, loc), variable, loc), call

    def _variable(self, scope: Any, of: Any, loc: Any) -> Any:
        self.made += 1
        variable = ir.Var(scope, f"$qtab{self.made}.{id(self)}", loc)
        self.typemap[variable.name] = of
        return variable


def _draws_elsewhere(function: Any) -> bool:
    if isinstance(function, str):
        return function.startswith(("np.random", "numpy.random", "random."))
    owner = getattr(function, "__self__", None)
    module = str(getattr(function, "__module__", "") or "")
    return isinstance(owner, np.random.RandomState | random.Random) or module.startswith(("numpy.random", "random"))
