"""Values that a function makes itself and to which nothing else refers, so that changing them has no effect."""

import ast
import builtins
import inspect
from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.rewriting.attributes import MISSING
from qtab.compilation.rewriting.infos.made import MOST_NESTED, bindings, is_made, values_of
from qtab.compilation.rewriting.source.sources import Source, source_of
from qtab.compilation.rewriting.source.syntax import own_name, parameters_of
from qtab.compilation.rewriting.values import is_immutable

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

METHODS = ("all", "any", "argmax", "argmin", "count", "index", "item", "max", "mean", "min", "std", "sum")
"""The methods whose results have no other name."""
BUILTINS = (abs, bool, float, int, len, round, str, sum)
"""The functions of one argument whose results have no other name."""
FUNCTIONS = (
    *(np.clip, np.count_nonzero, np.dot, np.linalg.norm, np.mean, np.median, np.prod, np.std, np.sum, np.var),
    *(np.argmax, np.argmin, np.where, divmod),
)
"""Other functions whose results have no other name; the same holds for ``math`` and NumPy's universal functions."""
ARRAYS = (np.empty, np.ones, np.zeros)
"""The functions that make arrays of numbers."""
DTYPES = (bool, float, int)
"""The dtypes that they may be given."""
_IMMUTABLE = (ast.Constant, ast.JoinedStr, ast.Compare, ast.UnaryOp, ast.Tuple)


def is_made_here(scope: "Expressions", node: ast.expr, function: FunctionType) -> bool:
    """Returns whether an expression is a variable that only ever holds what the function made."""
    source = source_of(function)
    is_variable = isinstance(node, ast.Name) and node.id not in parameters_of(source.node)
    return is_variable and is_made(scope.program.attributes, source, node)


def is_own(scope: "Expressions", node: ast.expr, function: FunctionType, depth: int = 0) -> bool:
    """Returns whether a value is a number or a string, or is made by the function and has no name elsewhere."""
    source = source_of(function)
    if depth > MOST_NESTED:
        return False

    def all_own(parts: list[ast.expr]) -> bool:
        return bool(parts) and all(is_own(scope, one, function, depth + 1) for one in parts)

    if isinstance(node, _IMMUTABLE):
        return True
    if not isinstance(node, ast.Name | ast.Subscript) and is_made(scope.program.attributes, source, node):
        return True
    match node:
        case ast.IfExp(body=body, orelse=other):
            return all_own([body, other])
        case ast.BoolOp(values=values):
            return all_own(values)
        case ast.Name(id=name) if name not in parameters_of(source.node):
            values = list(values_of(source, name))
            return len(values) == bindings(source, name) and all_own(values)
        case ast.Call(func=ast.Name() | ast.Attribute() as callee, args=args):
            found = resolved(callee, function)
            if _is_any(found, (min, max)):
                return len(args) > 1 and not node.keywords and all_own(args)
            if isinstance(callee, ast.Attribute) and found is MISSING:
                return callee.attr in METHODS and scope.program.attributes.find(callee.attr)[0] is MISSING
            is_known = isinstance(found, np.ufunc) or getattr(found, "__module__", None) == "math"
            return is_known or _is_any(found, FUNCTIONS) or (_is_any(found, BUILTINS) and len(args) == 1)
        case ast.Attribute(value=ast.Name(id=name), attr=attribute) if name == own_name(source.node):
            known = scope.program.attributes
            return is_immutable(vars(known.twin).get(attribute, known.find(attribute)[0]))
        case ast.Subscript(value=ast.Name(id=name)):
            return _holds_numbers(source, name)
        case ast.Subscript(
            value=ast.Attribute(value=ast.Name(id=name), attr=attribute), slice=ast.Constant(value=int())
        ):
            value = vars(scope.program.attributes.twin).get(attribute) if name == own_name(source.node) else None
            is_vector = isinstance(value, np.ndarray) and value.ndim == 1 and not value.dtype.hasobject
            return is_vector or (type(value) is tuple and all(map(is_immutable, value)))
        case ast.Subscript(value=ast.Call(func=ast.Name() as callee)):
            return resolved(callee, function) is divmod
    return False


def _holds_numbers(source: Source, name: str) -> bool:
    """Returns whether a variable has only arrays of numbers, so that nothing else refers to their elements."""
    values = list(values_of(source, name))
    is_alone = bool(values) and len(values) == bindings(source, name) and name not in parameters_of(source.node)
    return is_alone and all(_is_array(source, one) for one in values)


def _is_array(source: Source, node: ast.expr) -> bool:
    if not (isinstance(node, ast.Call) and _is_any(resolved(node.func, source.function), ARRAYS)):
        return False
    dtypes = [*node.args[1:], *(keyword.value for keyword in node.keywords if keyword.arg != "shape")]
    return all(_is_any(resolved(one, source.function), DTYPES) for one in dtypes)


def _is_any(value: Any, others: tuple[Any, ...]) -> bool:
    return any(value is one for one in others)


def resolved(node: ast.expr, function: FunctionType) -> Any:
    """Returns the constant that a name or a dotted name stands for; ``MISSING`` if it is none."""
    if isinstance(node, ast.Name):
        if node.id in function.__code__.co_varnames:
            return MISSING
        return inspect.getclosurevars(function).nonlocals.get(
            node.id, function.__globals__.get(node.id, getattr(builtins, node.id, MISSING))
        )
    if isinstance(node, ast.Attribute):
        owner = resolved(node.value, function)
        if isinstance(owner, ModuleType | type):
            return getattr(owner, node.attr, MISSING)
    return MISSING
