"""Floats in compiled code that are sometimes integers in Python, as in ``max(0, x)`` and ``n if up else x``.

Compiled code converts the integer where it meets the float. The float is equal to it up to 2**53, which is checked at
run time. Later results can still differ, since the integer 0 has no sign: ``-max(0, x)`` is 0 in Python, and would be
-0.0. Such operations are refused.
"""

import operator
from collections.abc import Iterable, Iterator
from types import CodeType
from typing import Any, TypeAlias

from numba.core import ir, types

from qtab.compilation.checks.checked_operations import INPLACE
from qtab.compilation.checks.typed_code import TypedCode

Path: TypeAlias = tuple[int, ...]
"""The indices that lead to a number within nested tuples; () for the number itself. ELEMENT stands for any index."""
Paths: TypeAlias = frozenset[Path]

ELEMENT = -1
NUMBER: Path = ()
NONE: Paths = frozenset()
INTEGER_RESULTS = (operator.mul, operator.floordiv, operator.mod)
"""Operators with another sign of zero, or another result, for integers than for floats."""
EXACT_RESULTS = (operator.add, operator.sub, operator.mul)
"""Operators whose results of integers may be too large for a float."""

MIXED_OPERATIONS = (*INTEGER_RESULTS, *EXACT_RESULTS, operator.truediv)


class Callees:
    """The mixed numbers that functions receive and return, by their code, during one compilation."""

    def __init__(self) -> None:
        self._parameters: dict[tuple[CodeType, int], Paths] = {}
        self._results: dict[CodeType, Paths] = {}
        self._asked: set[Any] = set()
        self.is_stale = False
        """Whether more is known now than when a function was compiled, so that all must be compiled again."""

    def clear(self) -> None:
        """Forgets everything, before another compilation."""
        self._parameters.clear()
        self._results.clear()
        self.begin()

    def begin(self) -> None:
        """Begins to compile all functions."""
        self._asked.clear()
        self.is_stale = False

    def parameter(self, code: CodeType, index: int) -> Paths:
        """Returns the mixed numbers in a parameter."""
        self._asked.add((code, index))
        return self._parameters.get((code, index), NONE)

    def give(self, code: CodeType, index: int, paths: Paths) -> None:
        """Notes mixed numbers in an argument of a function."""
        before = self._parameters.get((code, index), NONE)
        if not paths <= before:
            self._parameters[code, index] = before | paths
            self.is_stale = self.is_stale or (code, index) in self._asked

    def result(self, code: CodeType) -> Paths:
        """Returns the mixed numbers in the result of a function."""
        self._asked.add(code)
        return self._results.get(code, NONE)

    def note_result(self, code: CodeType, paths: Paths) -> None:
        """Notes mixed numbers in the result of a function."""
        before = self._results.get(code, NONE)
        if not paths <= before:
            self._results[code] = before | paths
            self.is_stale = self.is_stale or code in self._asked


callees = Callees()
"""Those of the compilation in progress."""


class MixedNumbers:
    """The mixed numbers in the code of one function.

    Args:
        code: The code.
        function: The function in Python.
    """

    def __init__(self, code: TypedCode, function: Any) -> None:
        self._code, self._function = code, function.__code__
        self._found: dict[str, Paths] = {}
        self.converted: dict[str, Paths] = {}
        """The integers in variables that become floats where they meet floats."""
        self._changed = True
        while self._changed:
            self._changed = False
            for block in code.state.func_ir.blocks.values():
                for statement in block.body:
                    self._statement(statement)

    def of(self, variable: Any) -> Paths:
        """Returns the mixed numbers in a variable."""
        return self._found.get(variable.name, NONE)

    def is_mixed(self, variable: Any) -> bool:
        """Returns whether a variable is a float that is sometimes an integer in Python."""
        return NUMBER in self.of(variable)

    def differs(self, function: Any, left: Any, right: Any) -> bool:
        """Returns whether an operator gives another result for the integers than for the floats."""
        if function not in INTEGER_RESULTS or not self.is_mixed_operation(left, right):
            return False
        constants = [self._code.constant(right), self._code.constant(left) if function is operator.mul else None]
        return not any(isinstance(one, int | float) and one > 0 for one in constants)

    def can_be_inexact(self, function: Any, left: Any, right: Any) -> bool:
        """Returns whether the result of an operator may be an integer beyond 2**53 in Python."""
        return function in EXACT_RESULTS and self.is_mixed_operation(left, right)

    def is_mixed_operation(self, left: Any, right: Any) -> bool:
        """Returns whether an operator may have two integers in Python, at least one of which is a float here."""
        sides = (left, right)
        return any(map(self.is_mixed, sides)) and all(self.is_mixed(one) or self._is_whole(one) for one in sides)

    def _is_whole(self, variable: Any) -> bool:
        return is_whole(self._code.type_of(variable))

    def _statement(self, statement: Any) -> None:
        if isinstance(statement, ir.Return):
            callees.note_result(self._function, self.of(statement.value))
        if not isinstance(statement, ir.Assign):
            return
        target, value = statement.target, statement.value
        if isinstance(value, ir.Var):
            self._flows(value, target)
        elif isinstance(value, ir.Arg):
            self._add(target, callees.parameter(self._function, value.index))
        elif isinstance(value, ir.Expr):
            self._expression(target, value)

    def _expression(self, target: Any, expression: Any) -> None:
        operation = expression.op
        if operation == "phi":
            for one in expression.incoming_values:
                if isinstance(one, ir.Var):
                    self._flows(one, target)
        elif operation in ("cast", "exhaust_iter", "getiter", "iternext"):
            self._flows(expression.value, target)
        elif operation in ("build_tuple", "build_list"):
            for index, item in enumerate(expression.items):
                place = index if operation == "build_tuple" else ELEMENT
                of = self._code.type_of(target)
                wanted = of.types[index] if isinstance(of, types.BaseTuple) else getattr(of, "dtype", None)
                self._flows(item, target, wanted, (place,))
        elif operation in ("static_getitem", "getitem", "pair_first"):
            at = getattr(expression, "index", None) if operation == "static_getitem" else None
            self._add(target, frozenset(_tails(self.of(expression.value), at)))
        elif operation == "unary" and expression.fn is operator.pos:
            self._flows(expression.value, target)
        elif operation in ("binop", "inplace_binop"):
            function = INPLACE.get(expression.fn, expression.fn)
            known = function in (*INTEGER_RESULTS, *EXACT_RESULTS)
            if known and self.is_mixed_operation(expression.lhs, expression.rhs):
                self._add(target, {NUMBER})
        elif operation == "call":
            self._call(target, expression)

    def _call(self, target: Any, expression: Any) -> None:
        of = self._code.typemap[expression.func.name]
        if isinstance(of, types.Function) and of.typing_key in (min, max, abs):
            for one in expression.args:
                self._flows(one, target)
        code, first = called_code(of)
        if code is None:
            return
        names = code.co_varnames[: code.co_argcount]
        for index, one in [
            *enumerate(expression.args, first),
            *((names.index(name), one) for name, one in expression.kws if name in names),
        ]:
            if paths := self.of(one):
                callees.give(code, index, paths)
        self._add(target, callees.result(code))

    def _flows(self, source: Any, target: Any, wanted: Any = None, place: Path = ()) -> None:
        """Notes that a value becomes that of a variable, or of an element of it."""
        given, wanted = self._code.type_of(source), wanted or self._code.type_of(target)
        paths = frozenset(converted(given, wanted))
        if paths and not paths <= self.converted.get(source.name, NONE):
            self.converted[source.name] = self.converted.get(source.name, NONE) | paths
        self._add(target, {(*place, *path) for path in self.of(source) | paths})

    def _add(self, target: Any, paths: Iterable[Path]) -> None:
        before = self.of(target)
        if not before.issuperset(paths := frozenset(paths)):
            self._found[target.name] = before | paths
            self._changed = True


def is_whole(of: Any) -> bool:
    """Returns whether a type is that of integers or booleans."""
    return isinstance(types.unliteral(of), types.Integer | types.Boolean)


def called_code(of: Any) -> tuple[CodeType | None, int]:
    """Returns the code of a user's function, given its type, and the index of the first parameter of a call of it."""
    if isinstance(of, types.Dispatcher):
        return of.dispatcher.py_func.__code__, 0
    if isinstance(of, types.BoundFunction):
        key = of.typing_key
        name = key[1] if isinstance(key, tuple) else str(key).rpartition(".")[2]
        method = getattr(of.this, "methods", {}).get(name)
        if method is not None:
            return method.__code__, 1
    return None, 0


def converted(given: Any, wanted: Any) -> Iterator[Path]:
    """Yields the integers of a type that are floats in another one."""
    given, wanted = types.unliteral(given), types.unliteral(wanted)
    if is_whole(given) and isinstance(wanted, types.Float):
        yield NUMBER
    elif isinstance(given, types.BaseTuple) and isinstance(wanted, types.BaseTuple) and len(given) == len(wanted):
        for index, pair in enumerate(zip(given, wanted, strict=True)):
            yield from ((index, *path) for path in converted(*pair))


def _tails(paths: Paths, index: Any) -> Iterator[Path]:
    for path in paths:
        if path and (index is None or path[0] in (index, ELEMENT) or not isinstance(index, int) or index < 0):
            yield path[1:]
