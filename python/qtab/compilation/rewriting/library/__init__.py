"""The functions and methods of Python, ``math`` and NumPy that compiled code computes to the same bits."""

import ast
from collections.abc import Callable
from typing import TYPE_CHECKING

from qtab.compilation.rewriting.values import Value

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

Handler = Callable[["Expressions", ast.Call, list[Value], dict[str, Value]], Value]
"""Returns the value of a call of a known function, given its arguments: those without and those with names."""

__all__ = ["Handler"]
