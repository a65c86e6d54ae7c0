"""Checks that integers within tuples and lists are floats too, where compiled code compares or joins them as floats."""

import functools
import operator
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from numba.core import types

from qtab.compilation.checks.checked_operations import INPLACE, compiled, exact_float, exact_integer, not_nan
from qtab.compilation.checks.mixed_numbers import ELEMENT, NUMBER, MixedNumbers, Path, Paths, converted
from qtab.compilation.checks.number_types import is_int64
from qtab.compilation.checks.typed_code import TypedCode

Side = tuple[Any, Paths]
"""A variable, and the integers in it that are compared with floats."""


def check_integers(code: TypedCode, scope: Any, variable: Any, paths: Paths, loc: Any) -> list[Any]:
    """Returns the statements that check integers in a variable: an error is raised beyond 2**53.

    A constant is refused here, if it is no float.
    """
    if paths == {NUMBER}:
        constant = getattr(code.type_of(variable), "literal_value", None)
        if isinstance(constant, int):
            if int(float(constant)) == constant:
                return []
            reason = f"the integer {constant}, which is used with floats but cannot be represented exactly as float64"
            return code.refuse(SimpleNamespace(loc=loc), reason, "write a float, such as 1e18 or math.inf")
    of_int64 = _of_int64(code.type_of(variable), paths)
    return code.check(_checker(of_int64), scope, [variable], loc) if of_int64 else []


def check_compared(code: TypedCode, scope: Any, variable: Any, paths: Paths, loc: Any) -> list[Any]:
    """Returns the statements that check numbers in a variable that are compared with floats within tuples and lists.

    Python finds a NaN equal to itself there, because it compares objects first; an error is raised at a NaN.
    """
    found = check_integers(code, scope, variable, paths, loc)
    floats = frozenset(path for path in paths if isinstance(_at(code.type_of(variable), path), types.Float))
    return [*found, *(code.check(_checker(floats, True), scope, [variable], loc) if floats else [])]


def check_mixed_operation(code: TypedCode, expression: Any, scope: Any) -> list[Any]:
    """Returns the statements that check the integers of an operation that has two integers in Python."""
    found = []
    for side in (expression.lhs, expression.rhs):
        if is_int64(code.type_of(side)):
            found += check_integers(code, scope, side, frozenset({NUMBER}), expression.loc)
    return found


def checks_after(code: TypedCode, mixed: MixedNumbers, statement: Any, scope: Any) -> list[Any]:
    """Returns the statements that check a variable where it is assigned.

    Args:
        code: The code.
        mixed: Its mixed numbers.
        statement: The assignment.
        scope: The scope of its block.
    """
    target, value = statement.target, statement.value
    if paths := mixed.converted.get(target.name):
        return check_integers(code, scope, target, paths, statement.loc)
    is_operation = getattr(value, "op", "") in ("binop", "inplace_binop") and mixed.is_mixed(target)
    if is_operation and mixed.can_be_inexact(INPLACE.get(value.fn, value.fn), value.lhs, value.rhs):
        return code.check(exact_float, scope, [target], statement.loc)
    return []


def exact_checker(given: Any, wanted: Any) -> Any:
    """Returns a function for compiled code that checks the integers of a type which become floats in another one."""
    return _checker(_of_int64(given, frozenset(converted(given, wanted))))


def _of_int64(of: Any, paths: Paths) -> Paths:
    return frozenset(path for path in paths if _at(of, path) == types.int64)


def compared(expression: Any, left: Any, right: Any) -> list[Side]:
    """Returns the integers that a comparison of tuples, or ``in``, compares with floats.

    Args:
        expression: The comparison.
        left: The type of its left side; that of the container for ``in``.
        right: The type of its right side.
    """
    if expression.fn is operator.contains:
        pairs = [pair for place, one in _elements(left) for pair in _pairs(one, right, place, ())]
    elif isinstance(left, types.BaseTuple) and isinstance(right, types.BaseTuple):
        pairs = list(_pairs(left, right, (), ()))
    else:
        return []
    sides = zip((expression.lhs, expression.rhs), zip(*pairs, strict=True), strict=True) if pairs else []
    return [(side, frozenset(path for path in paths if path is not None)) for side, paths in sides]


def _elements(of: Any) -> Iterator[tuple[Path, Any]]:
    if isinstance(of, types.BaseTuple):
        yield from (((index,), one) for index, one in enumerate(of))
    elif isinstance(of, types.List | types.Set | types.ListType):
        yield (ELEMENT,), of.dtype


def _pairs(one: Any, other: Any, path: Path, other_path: Path) -> Iterator[tuple[Path | None, Path | None]]:
    """Yields the places of numbers that are compared with floats: in the first value, or in the second."""
    one, other = types.unliteral(one), types.unliteral(other)
    if isinstance(one, types.BaseTuple) and isinstance(other, types.BaseTuple):
        for index, (inner, outer) in enumerate(zip(one, other, strict=False)):
            yield from _pairs(inner, outer, (*path, index), (*other_path, index))
    elif (one == types.int64 or isinstance(one, types.Float)) and isinstance(other, types.Float):
        yield path, None
    elif other == types.int64 and isinstance(one, types.Float):
        yield None, other_path


def _at(of: Any, path: Path) -> Any:
    for index in path:
        of = of.dtype if index == ELEMENT else of[index]
    return types.unliteral(of)


@functools.cache
def _checker(paths: Paths, are_floats: bool = False) -> Any:
    """Returns a function of a value that checks the integers at paths, or that the floats there are not NaN."""
    check = not_nan if are_floats else exact_integer
    if paths == {NUMBER}:
        return check
    lines = ["def check(value):", "    pass"]
    for path in sorted(paths):
        indent, found = "    ", "value"
        for depth, index in enumerate(path):
            if index == ELEMENT:
                lines.append(f"{indent}for item{depth} in {found}:")
                indent, found = indent + "    ", f"item{depth}"
            else:
                found = f"{found}[{index}]"
        lines.append(f"{indent}checked({found})")
    scope: dict[str, Any] = {"checked": check}
    exec("\n".join(lines), scope)  # noqa: S102 - code of this module
    return compiled(scope["check"])
