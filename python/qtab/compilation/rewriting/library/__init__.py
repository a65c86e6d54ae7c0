"""The functions and methods of Python, ``math`` and NumPy that compiled code computes to the same bits."""

import ast
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from qtab.compilation.rewriting.values import Value, constant

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

Handler = Callable[["Expressions", ast.Call, list[Value], dict[str, Value]], Value]
"""Returns the value of a call of a known function, given its arguments: those without and those with names."""

__all__ = ["Handler", "arguments", "bound"]


def bound(
    scope: "Expressions", node: ast.AST, names: Sequence[str], values: list[Value], named: dict[str, Value]
) -> dict[str, Value]:
    """Returns the arguments of a known function by name."""
    if len(values) > len(names) or not set(named) <= set(names):
        unknown = sorted(set(named) - set(names))
        what = f"the argument {unknown[0]}" if unknown else "so many arguments"
        raise scope.refuse(node, f"{what} of this function cannot be compiled", "leave it out")
    return {**dict(zip(names, values, strict=False)), **named}


def arguments(
    scope: "Expressions", node: ast.AST, names: tuple[str, ...], values: list[Value], named: dict[str, Value]
) -> list[Value]:
    """Returns the values of the named parameters in order; those that are missing are None."""
    chosen = bound(scope, node, names, values, named)
    return [chosen.get(name, constant(None)) for name in names]
