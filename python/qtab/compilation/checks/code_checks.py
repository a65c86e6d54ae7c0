"""Checks where Python raises errors, and refusals where bits can differ, in the code of users' functions."""

import math
import operator
import random
from typing import Any

import numpy as np
from numba.core import ir, types

from qtab.compilation.checks import containers
from qtab.compilation.checks.builtin_calls import check_builtin, is_builtin
from qtab.compilation.checks.checked_operations import (
    DRAW_CHECKS,
    FLOAT_RANGE_CHECKS,
    INPLACE,
    INTEGER_OPERATIONS,
    MATH,
    RANGE_CHECKS,
    exact_integer,
    negative,
    to_int,
)
from qtab.compilation.checks.exact_values import (
    check_compared,
    check_integers,
    check_mixed_operation,
    checks_after,
    compared,
)
from qtab.compilation.checks.known_functions import (
    DRAWS,
    DRAWS_DIFFERENT,
    MATH_ADVICE,
    MATH_ROUNDED,
    MATH_TESTS,
    OTHER_MATH,
)
from qtab.compilation.checks.lost_numbers import MAKE_ARRAYS, LostNumbers
from qtab.compilation.checks.made_arrays import arrays_differ, check_of
from qtab.compilation.checks.mixed_numbers import MIXED_OPERATIONS, NUMBER, MixedNumbers
from qtab.compilation.checks.number_types import (
    CONVERT,
    NUMBERS,
    holds,
    is_int64,
    is_narrow,
    joins_boolean,
    leaf,
    mixed,
    wide_instead,
)
from qtab.compilation.checks.numpy_calls import check_array_method, check_numpy_call
from qtab.compilation.checks.typed_code import TypedCode

MIXED = "a number that is sometimes an integer and sometimes a float: the sign of a zero would differ"
WRITE_FLOATS = "write a float in every case, such as 0.0 for 0"
COMPARISONS = (operator.lt, operator.le, operator.gt, operator.ge, operator.eq, operator.ne)


class Checks(TypedCode):
    """The checks of the code of one function."""

    def run(self) -> bool:
        """Changes the code; returns whether there were changes."""
        self.mixed = MixedNumbers(self, self.state.func_id.func)
        self.lost = LostNumbers(self, self.mixed)
        for block in self.state.func_ir.blocks.values():
            body: list[Any] = []
            after: list[Any] = []
            for statement in block.body:
                if self.lost.in_statement(statement):
                    self.refuse(statement, MIXED, WRITE_FLOATS)
                elif (refused := containers.refused(self, statement)) is not None:
                    self.refuse(statement, *refused)
                if not (isinstance(statement, ir.Assign) and getattr(statement.value, "op", "") == "phi"):
                    body, after = body + after, []
                if isinstance(statement, ir.Assign) and isinstance(statement.value, ir.Expr):
                    body += self._expression(statement, block.scope)
                elif isinstance(statement, ir.Assign) and isinstance(statement.value, ir.Var):
                    self._widening(statement, [statement.value])
                elif isinstance(statement, ir.SetItem | ir.StaticSetItem):
                    body += self._store(statement, block.scope)
                body.append(statement)
                if isinstance(statement, ir.Assign):
                    if isinstance(leaf(self.type_of(statement.target)), types.Complex):
                        self.refuse(statement, "a complex number", "compute its real and imaginary parts")
                    after += checks_after(self, self.mixed, statement, block.scope)
            block.body = body + after
        return self.made > 0

    def _store(self, statement: Any, scope: Any) -> list[Any]:
        of, value = self.type_of(statement.target), types.unliteral(self.type_of(statement.value))
        if isinstance(of, types.NumpyFlatType) and not of.array_type.mutable:
            self.refuse(statement, "array.flat changes an array of self", "copy the array first")
        elif isinstance(of, types.Array) and (check := check_of(of.dtype, value)) is not None:
            return self.check(check, scope, [statement.value], statement.loc)
        elif isinstance(of, types.Record) and isinstance(statement, ir.StaticSetItem):
            field = of.typeof(statement.index) if isinstance(statement.index, str) else None
            if isinstance(field, types.Float) and value == types.int64:
                return self.check(exact_integer, scope, [statement.value], statement.loc)
        return []

    def _widening(self, statement: Any, sources: list[Any]) -> None:
        """Refuses a number whose type is another one in Python, where it comes from another branch."""
        kinds = [leaf(self.type_of(source)) for source in sources]
        target = leaf(self.type_of(statement.target))
        if any(joins_boolean(self.type_of(source), self.type_of(statement.target)) for source in sources):
            self.refuse(statement, "a number that is sometimes a boolean", "convert the boolean with int(...)")
        elif any((is_narrow(kind) or kind == types.float32) and kind != target for kind in kinds):
            self.refuse(statement, "numbers of several types", CONVERT)

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
            of = types.unliteral(self.type_of(expression.value))
            if isinstance(of, types.Boolean):
                self.refuse(expression, "arithmetic of booleans", "write not x, or convert it with int(...)")
            elif is_narrow(leaf(of)):
                self.refuse(expression, mixed([leaf(of)]), "convert it with np.int64(...)")
            elif expression.fn is operator.neg and self.mixed.is_mixed(expression.value):
                self.refuse(expression, MIXED, WRITE_FLOATS)
            elif expression.fn is operator.neg and isinstance(of, types.Integer):
                return self.replace(statement, scope, negative, [expression.value], [types.int64])
        return []

    def _operation(self, statement: Any, scope: Any) -> list[Any]:
        expression = statement.value
        function = INPLACE.get(expression.fn, expression.fn)
        given = [self.type_of(expression.lhs), self.type_of(expression.rhs)]
        kinds = [leaf(one) for one in given]
        if not all(isinstance(kind, NUMBERS) for kind in kinds):
            sides = compared(expression, *given) if function in (*COMPARISONS, operator.contains) else []
            return [one for side, paths in sides for one in check_compared(self, scope, side, paths, expression.loc)]
        if function is operator.matmul:
            return self.refuse(expression, "a matrix product may add in another order", "add in a loop")
        if function not in INTEGER_OPERATIONS and function not in COMPARISONS:
            return []
        if function in COMPARISONS:
            kinds = self._kinds_that_differ(expression, kinds)
        if reason := mixed(kinds):
            return self.refuse(expression, reason, CONVERT)
        if self.mixed.differs(function, expression.lhs, expression.rhs):
            return self.refuse(expression, MIXED, WRITE_FLOATS)
        if function in MIXED_OPERATIONS and self.mixed.is_mixed_operation(expression.lhs, expression.rhs):
            return check_mixed_operation(self, expression, scope)
        scalars = not any(isinstance(one, types.Array) for one in given)
        if not scalars and self.lost.in_array(expression.lhs, expression.rhs):
            return self.refuse(expression, MIXED, WRITE_FLOATS)
        integers = scalars and all(isinstance(kind, types.Integer | types.Boolean) for kind in kinds)
        if function in COMPARISONS:
            return self._comparison(expression, scope, given) if scalars else []
        if not scalars and (reason := arrays_differ(function, kinds, self.constant(expression.rhs))):
            return self.refuse(expression, reason, "write a loop over the elements")
        if function is operator.pow:
            exponent = getattr(given[1], "literal_value", None)
            if not integers or not isinstance(exponent, int) or exponent < 0:
                return self.refuse(expression, "a power can differ in the last bit", "write products: x * x for x ** 2")
        sides = [expression.lhs, expression.rhs]
        booleans = all(isinstance(kind, types.Boolean) for kind in kinds)
        if booleans and not (scalars and all(map(self._compares_action, sides))):
            # Those of NumPy are not added as those of Python are, and have the same type here.
            return self.refuse(expression, "arithmetic of booleans", "convert them with int(...)")
        return (
            self.replace(statement, scope, INTEGER_OPERATIONS[function], sides, [types.int64] * 2) if integers else []
        )

    def _kinds_that_differ(self, expression: Any, kinds: list[Any]) -> list[Any]:
        """Returns the types of the operands of a comparison, without those that are compared exactly."""
        constants = [self.constant(side) for side in (expression.lhs, expression.rhs)]
        if kinds[0] == kinds[1] or holds(kinds[0], constants[1]) or holds(kinds[1], constants[0]):
            return []
        if all(is_narrow(kind) <= (kind != types.uint64) for kind in kinds):
            return [kind for kind in kinds if not is_narrow(kind)]
        return kinds

    def _comparison(self, expression: Any, scope: Any, given: list[Any]) -> list[Any]:
        """Returns the check of an integer that is compared with a float, which compiled code rounds."""
        kinds = [types.unliteral(one) for one in given]
        for kind, other, side in zip(kinds, reversed(kinds), (expression.lhs, expression.rhs), strict=True):
            if kind == types.int64 and isinstance(other, types.Float):
                return check_integers(self, scope, side, frozenset({NUMBER}), expression.loc)
        return []

    def _compares_action(self, variable: Any) -> bool:
        """Returns whether a variable is a comparison of the action with a constant, which is a boolean of Python."""
        found = self.definition(variable)
        if not isinstance(found, ir.Expr) or found.op != "binop" or found.fn not in COMPARISONS:
            return False
        sides = [self.definition(side) for side in (found.lhs, found.rhs)]
        return all(isinstance(one, ir.Const) or (isinstance(one, ir.Arg) and one.name == "action") for one in sides)

    def _call(self, statement: Any, scope: Any) -> list[Any]:
        expression = statement.value
        function = self.typemap[expression.func.name]
        given = [self.type_of(one) for one in expression.args]
        if isinstance(function, types.BoundFunction):
            return self._method_call(statement, scope, given)
        if expression.vararg is not None and isinstance(function, types.NumberClass | types.Function):
            return self.refuse(expression, "a call with *arguments", "write the arguments one by one")
        if isinstance(function, types.NumberClass):
            of, value = function.instance_type, types.unliteral(given[0]) if given else None
            if given and not isinstance(value, NUMBERS):
                return self.refuse(expression, f"{of} of {value}", "convert a number")
            if of == types.int64 and isinstance(value, types.Float):
                return self.replace(statement, scope, to_int, expression.args, [types.float64])
            if of in FLOAT_RANGE_CHECKS and isinstance(value, types.Float):
                return self.check_arguments(expression, scope, FLOAT_RANGE_CHECKS[of])
            if (is_narrow(of) or of == types.float32) and isinstance(value, types.Integer):
                check = check_of(of, value)
                return [] if check is None else self.check_arguments(expression, scope, check)
            if of == types.int64 and value == types.uint64:
                return self.check_arguments(expression, scope, RANGE_CHECKS[types.uint64])
            return []
        if not isinstance(function, types.Function):
            return []
        key = function.typing_key
        called = self.constant(expression.func)
        name = str(getattr(key, "__name__", key)).rpartition(".")[2]
        if any(map(_draws_elsewhere, (key, called))):
            self.refuse(expression, f"{name} does not draw from the generator of the environment", "draw from rng")
        elif is_builtin(key):
            return check_builtin(self, statement, scope, key)
        elif getattr(key, "__module__", None) == "math" or getattr(math, name, None) is key:
            return self._math_call(statement, scope, key, name)
        elif isinstance(key, np.ufunc) or str(getattr(key, "__module__", "")).partition(".")[0] == "numpy":
            if self.lost.in_numpy(expression, name):
                advice = f"give a dtype, such as np.float64, or {WRITE_FLOATS}" if name in MAKE_ARRAYS else WRITE_FLOATS
                return self.refuse(expression, MIXED, advice)
            return check_numpy_call(self, statement, scope, key, name)
        else:
            self.refuse(expression, f"{name} may give another result in compiled code", "write operators")
        return []

    def _math_call(self, statement: Any, scope: Any, key: Any, name: str) -> list[Any]:
        expression = statement.value
        if key is math.gcd:
            return []
        if key not in MATH:
            advice = MATH_ADVICE.get(name, OTHER_MATH)
            return self.refuse(expression, f"math.{name} may round differently in compiled code", advice)
        kinds = [types.unliteral(self.type_of(one)) for one in expression.args]
        if types.float32 in kinds and name not in ("floor", "ceil", *MATH_TESTS):  # Python's trunc takes no float32
            return self.refuse(expression, f"math.{name} of a float32", "convert it: float(...)")
        integer = name in MATH_ROUNDED and isinstance(types.unliteral(self.type_of(expression.args[0])), types.Integer)
        check = self.check(exact_integer, scope, expression.args, expression.loc) if integer else []
        return [*check, *self.replace(statement, scope, MATH[key], expression.args, None)]

    def _method_call(self, statement: Any, scope: Any, given: list[Any]) -> list[Any]:
        expression = statement.value
        of, key = self.type_of(expression.func).this, self.type_of(expression.func).typing_key
        name = key[1] if isinstance(key, tuple) else str(key).rpartition(".")[2]
        if isinstance(of, types.NumPyRandomGeneratorType):
            if name in DRAWS_DIFFERENT:
                self.refuse(expression, f"{name} can draw other numbers", "draw from another distribution")
            elif name == "shuffle" and not getattr(given[0], "mutable", True):
                self.refuse(expression, "shuffle changes an array of self", "copy the array first")
            elif name in DRAWS:
                floats = [] if name == "binomial" else [*expression.args, *(one for _, one in expression.kws)]
                checks = [self.check_integer_argument(one, scope, expression.loc) for one in floats]
                own = self.check_arguments(expression, scope, DRAW_CHECKS[name]) if name in DRAW_CHECKS else []
                return [*(one for check in checks for one in check), *own]
        elif isinstance(of, types.Array):
            return check_array_method(self, expression, scope, name, of)
        elif name == "item" and (is_narrow(of) or of == types.float32):
            return self.refuse(expression, f"item() of {of} keeps its dtype", wide_instead(of))
        return []

    def check_integer_argument(self, variable: Any, scope: Any, loc: Any) -> list[Any]:
        """Returns the check of an integer that NumPy converts to a float before it computes with it."""
        of = self.type_of(variable)
        return check_integers(self, scope, variable, frozenset({NUMBER}), loc) if is_int64(of) else []


def _draws_elsewhere(function: Any) -> bool:
    if isinstance(function, str):
        return function.startswith(("np.random", "numpy.random", "random."))
    owner = getattr(function, "__self__", None)
    module = str(getattr(function, "__module__", "") or "")
    return isinstance(owner, np.random.RandomState | random.Random) or module.startswith(("numpy.random", "random"))
