"""Expressions that are left out, such as info dicts: they must have no effects."""

import ast
import builtins
import enum
import inspect
from types import FunctionType
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.attributes import MISSING
from qtab.compilation.rewriting.source.sources import source_of
from qtab.compilation.rewriting.source.syntax import CHANGING, own_name
from qtab.compilation.rewriting.statements.own_values import is_made_here, is_own, resolved
from qtab.compilation.twins.own_code import own_methods, runs_code

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

PURE_BUILTINS = (
    *("abs", "all", "any", "bool", "dict", "divmod", "enumerate", "float", "frozenset", "getattr", "hasattr", "int"),
    *("isinstance", "len", "list", "max", "min", "pow", "range", "repr", "reversed", "round", "set", "sorted", "str"),
    *("sum", "tuple", "type", "zip", "map", "filter", "bin"),
)
PURE_METHODS = (
    *("all", "any", "argmax", "argmin", "astype", "copy", "count", "flatten", "format", "get", "index", "item"),
    *("items", "join", "keys", "lower", "max", "mean", "min", "ravel", "reshape", "round", "std", "sum", "title"),
    *("tobytes", "tolist", "upper", "values"),
)
MOST_ARGUMENTS = {
    **dict.fromkeys(("all", "any", "argmax", "argmin", "max", "min", "round"), 1),
    **dict.fromkeys(("mean", "std", "sum"), 2),
}
"""How many arguments an array's method takes before ``out``."""
LOCAL_METHODS = ("add", "append", "extend", "insert", "pop", "sort", "update")
"""Methods that change a list or a dict that the function made."""
CHANGES_ARGUMENT = ("copyto", "fill_diagonal", "nan_to_num", "place", "put", "put_along_axis", "putmask")
"""Functions of NumPy that change an array."""
UNSAFE_NUMPY = ("save", "load", "fromfile", "memmap", "open", "set", "genfromtxt", "fromregex", "DataSource", "test")
"""The beginnings of the names of NumPy's functions that use files or change NumPy."""
EFFECTIVE = (
    *(ast.NamedExpr, ast.Yield, ast.YieldFrom, ast.Await, ast.Global, ast.Nonlocal, ast.Delete),
    *(ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef),
)
"""Statements and expressions that are not left out."""
ADVICE = "compute it without drawing or changing attributes, or leave it out"


def check_pure(scope: "Expressions", node: ast.AST) -> None:
    """Refuses an expression that is left out, such as an info dict, if evaluating it may have effects."""
    found = effect_of(scope, node)
    if found is not None:
        raise scope.refuse(node, f"this is left out in compiled code, but {found}", ADVICE)


def effect_of(scope: "Expressions", node: ast.AST) -> str | None:
    """Returns the effect of an expression, in words; None if there is none."""
    return _effect(scope, node, scope.source.function, scope.source.node, set())


def _effect(
    scope: "Expressions", node: ast.AST, function: FunctionType, definition: ast.FunctionDef, seen: set[Any]
) -> str | None:
    """Returns the effect of an expression or statement; None if there is none."""
    own = own_name(definition)
    called = {id(one.func) for one in ast.walk(node) if isinstance(one, ast.Call)}
    for one in ast.walk(node):
        if isinstance(one, EFFECTIVE):
            return f"it contains {type(one).__name__}"
        if isinstance(one, ast.withitem) and not isinstance(one.context_expr, ast.Call):  # calls are checked
            return f"it enters {ast.unparse(one.context_expr)}"
        if isinstance(one, ast.Attribute) and one.attr in ("np_random", "_np_random"):
            return "it draws random numbers"
        is_argument = isinstance(one, ast.Attribute) and one.attr in CHANGING and id(one) not in called
        if is_argument and not is_own(scope, one, function):  # type: ignore[arg-type]
            return f"it passes on {ast.unparse(one)}"
        is_element = isinstance(one, ast.Subscript) and is_made_here(scope, one.value, function)
        if isinstance(one, ast.Attribute | ast.Subscript) and isinstance(one.ctx, ast.Store) and not is_element:
            return f"it assigns {ast.unparse(one)}"
        if isinstance(one, ast.AugAssign) and not is_own(scope, one.target, function):
            return f"it may change the value of {ast.unparse(one.target)}"
        if isinstance(one, ast.Attribute) and isinstance(one.value, ast.Name) and one.value.id == own:
            member, _ = scope.program.attributes.find(one.attr)
            method = getattr(member, "__func__", member)
            if isinstance(member, property) or isinstance(method, FunctionType):
                inner = _of_function(scope, member.fget if isinstance(member, property) else method, seen)
                if inner is not None:
                    return inner
        if isinstance(one, ast.Name | ast.Attribute):
            found = resolved(one, function)
            if isinstance(found, FunctionType) and not _is_library(found):  # which may be an argument, such as key=
                inner = _of_function(scope, found, seen)
                if inner is not None:
                    return inner
            found = _of_operators(scope, constant_of(scope, one, function, own), seen)
            if found is not None:
                return found
        if isinstance(one, ast.Call):
            found = _of_call(scope, one, function, own, seen)
            if found is not None:
                return found
    return None


def constant_of(scope: "Expressions", node: ast.expr, function: FunctionType, own: str | None) -> Any:
    """Returns the constant that a name, or an attribute, stands for; ``MISSING`` if it is none."""
    if isinstance(node, ast.Name):
        found = scope.fixed.get(node.id) if function is scope.source.function else None
        return resolved(node, function) if found is None else found.fixed
    if not isinstance(node, ast.Attribute):
        return MISSING
    if isinstance(node.value, ast.Name) and node.value.id == own:
        known = scope.program.attributes
        found = vars(known.env).get(node.attr, known.find(node.attr)[0])
        return MISSING if node.attr in known.assigned or isinstance(found, property) else found
    owner = constant_of(scope, node.value, function, own)
    return MISSING if owner is MISSING or runs_code(owner, node.attr) else getattr(owner, node.attr, MISSING)


def _of_operators(scope: "Expressions", value: Any, seen: set[Any]) -> str | None:
    """Returns the effect of a method that Python calls to compute with a constant or to show it; None without any."""
    for name, method in own_methods(value):
        found = _of_function(scope, method, seen)
        if found is not None:
            return f"{type(value).__name__} defines {name}, and {found}"
    return None


def _of_function(scope: "Expressions", function: Any, seen: set[Any]) -> str | None:
    if not isinstance(function, FunctionType) or hasattr(function, "__wrapped__"):
        return f"it calls {getattr(function, '__name__', 'a function')}, whose effects are unknown"
    if function in seen:
        return None
    try:
        definition = source_of(function).node
    except NotCompilable:
        return f"it calls {function.__name__}, whose source code is not available"
    for statement in definition.body:
        found = _effect(scope, statement, function, definition, seen | {function})
        if found is not None:
            return found
    return None


def _of_call(
    scope: "Expressions", node: ast.Call, function: FunctionType, own: str | None, seen: set[Any]
) -> str | None:
    callee = node.func
    shown = ast.unparse(callee)
    if isinstance(callee, ast.Attribute) and isinstance(callee.value, ast.Name) and callee.value.id == own:
        member, _ = scope.program.attributes.find(callee.attr)
        return _of_function(scope, getattr(member, "__func__", member), seen)
    found = resolved(callee, function)
    if isinstance(callee, ast.Attribute) and found is MISSING:
        owner = resolved(callee.value, function)
        simple = owner is MISSING or isinstance(owner, np.ndarray | str | dict | list | tuple)
        is_method = callee.attr in PURE_METHODS and scope.program.attributes.find(callee.attr)[0] is MISSING
        if simple and is_method and not _has_output(callee.attr, node):
            return None
        is_local = owner is MISSING and function is not scope.source.function
        if is_local and callee.attr in LOCAL_METHODS and is_made_here(scope, callee.value, function):
            return None
        return f"it calls {shown}, whose effects are unknown"
    if isinstance(found, FunctionType) and not _is_library(found):
        return _of_function(scope, found, seen)
    if isinstance(found, enum.EnumMeta):
        has_code = any("_missing_" in vars(base) for base in found.__mro__ if base.__module__ != "enum")
        return f"{found.__name__} defines _missing_" if has_code else None
    if isinstance(found, type) and found.__module__ == "builtins" and issubclass(found, BaseException):
        return None
    name = getattr(found, "__name__", "")
    is_lookup = found is getattr or found is hasattr
    if is_lookup and node.args and isinstance(node.args[0], ast.Name) and node.args[0].id == own:
        key = node.args[1] if len(node.args) > 1 else None
        member = scope.program.attributes.find(str(key.value))[0] if isinstance(key, ast.Constant) else property()
        return f"it calls {ast.unparse(node)}, which may compute an attribute" if isinstance(member, property) else None
    if name in PURE_BUILTINS and getattr(builtins, name) is found:
        return None
    if _is_library(found) and not _changes_argument(found, node):
        return None
    return f"it calls {shown}, whose effects are unknown"


def _has_output(name: str, node: ast.Call) -> bool:
    """Returns whether a call of an array's method may give ``out=``, also by position."""
    is_starred = any(isinstance(one, ast.Starred) for one in node.args)
    is_named = any(one.arg in ("out", None) for one in node.keywords)
    return name in MOST_ARGUMENTS and (is_starred or is_named or len(node.args) > MOST_ARGUMENTS[name])


def _is_library(value: Any) -> bool:
    """Returns whether a function is one of NumPy, but not of its random numbers, or of ``math``."""
    module = str(getattr(value, "__module__", None) or "")
    numpy = isinstance(value, np.ufunc) or module.partition(".")[0] == "numpy"
    bound = getattr(value, "__self__", None)
    is_random = "random" in module or isinstance(bound, np.random.Generator | np.random.RandomState)
    return (numpy and not is_random) or module == "math"


def _changes_argument(function: Any, node: ast.Call) -> bool:
    """Returns whether a call of a function of NumPy may change one of its arguments, a file or NumPy itself."""
    name = getattr(function, "__name__", "")
    if (
        name in CHANGES_ARGUMENT
        or name.startswith(UNSAFE_NUMPY)
        or any(one.arg in ("out", None) for one in node.keywords)
    ):
        return True
    if any(isinstance(one, ast.Starred) for one in node.args):
        return True
    if isinstance(function, np.ufunc):
        return len(node.args) > function.nin
    try:
        given = list(inspect.signature(function).parameters)[: len(node.args)]
    except (TypeError, ValueError):  # a function in C, of which these take out= by position
        return name in ("concat", "concatenate", "dot") and len(node.args) > 2
    return "out" in given
