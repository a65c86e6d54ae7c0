"""Calls: of the user's functions, which become functions of the program, and of known functions."""

import ast
import enum
import inspect
from types import BuiltinFunctionType, FunctionType, MethodType
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.expressions import containers
from qtab.compilation.rewriting.library import arrays, builtin_functions, draws, math_functions, numpy_functions
from qtab.compilation.rewriting.source.sources import source_of
from qtab.compilation.rewriting.source.syntax import CHANGING
from qtab.compilation.rewriting.statements.effects import check_pure
from qtab.compilation.rewriting.statements.left_out import known_value, note_message
from qtab.compilation.rewriting.values import Array, DictKind, InfoKind, TupleKind, Value, constant, in_words

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions


MODULE_ADVICE = {
    "random": ("random numbers of the module random", "draw from self.np_random"),
    "numpy.random": ("random numbers outside self.np_random", "draw from self.np_random"),
    "time": ("the clock is read", "count steps instead of seconds"),
    "datetime": ("the clock is read", "count steps instead of seconds"),
    "os": ("the system is used", "do it in __init__"),
    "io": ("a file is opened", "read files in __init__"),
    "_io": ("a file is opened", "read files in __init__"),
    "pathlib": ("a file is opened", "read files in __init__"),
    "pygame": ("pygame is called", "draw only in render()"),
    "logging": ("a logger is called", "log in a wrapper or a callback"),
    "copy": ("copy is called", "write array.copy()"),
    "collections": ("a collection is made while stepping", "use a NumPy array of fixed size"),
    "scipy": ("scipy is called", "compute the numbers in __init__, or write them with math"),
    "torch": ("torch is called", "use NumPy and math"),
}
SIDE_EFFECTS: dict[Any, tuple[str, str]] = {
    print: ("print is called", "log in a wrapper or a callback"),
    open: MODULE_ADVICE["io"],
    input: ("input is called", "read settings in __init__"),
}


def call(scope: "Expressions", node: ast.Call) -> Value:
    """Returns the value of a call."""
    if isinstance(node.func, ast.Name) and node.func.id == "super" and not node.args:
        if scope.owner is None:
            raise scope.refuse(node, "super() outside of a method", "call the base class's method in a method")
        return constant(specials.Super(scope.owner))
    if isinstance(node.func, ast.Attribute):
        base = scope.expression(node.func.value)
        name = node.func.attr
        if base.fixed is specials.RNG:
            return draws.draw(scope, node, name)
        if isinstance(base.kind, Array) or isinstance(base.fixed, np.ndarray):
            return arrays.method(scope, node, name, base)
        if isinstance(base.fixed, spaces.Space):
            return _space(scope, node, name, base.fixed)
        if isinstance(base.fixed, dict | list | tuple | str | set | frozenset | range):
            return _of_constant(scope, node, name, base.fixed)
        is_list = isinstance(base.kind, TupleKind) and isinstance(known_value(scope, node.func.value), list)
        if is_list and name == "copy" and not (node.args or node.keywords):
            return containers.copied(base)
        if isinstance(base.kind, DictKind | InfoKind) or (base.kind is not None and not base.is_fixed):
            if isinstance(base.kind, TupleKind) and name in CHANGING:
                unread = "a list that nothing reads is left out if reset makes it, as in self.path = []"
                advice = f"use numbers and NumPy arrays of fixed size; {unread}"
                raise scope.refuse(node, f"the method {name} of a list", advice)
            raise scope.refuse(node, f"the method {name} of {in_words(base.kind)}", "use numbers and NumPy arrays")
        callee = scope.attribute_of(node.func, base)
    else:
        callee = scope.expression(node.func)
    if not callee.is_fixed:
        raise scope.refuse(node, f"{in_words(callee.kind)} is called", "call functions and methods by name")
    return _known(scope, node, callee.fixed)


def arguments(scope: "Expressions", node: ast.Call) -> tuple[list[Value], dict[str, Value]]:
    """Returns the values of the arguments."""
    values = containers.unpacked(scope, node.args)
    named = {}
    for keyword in node.keywords:
        if keyword.arg is None:
            raise scope.refuse(node, "arguments are unpacked from a dict", "write the arguments")
        named[keyword.arg] = scope.expression(keyword.value)
    # Compiled code evaluates them in the order of the parameters, which does not matter for constants, such as a dtype.
    computed = any(not value.is_fixed or scope.has_effects(value) for value in named.values())
    if computed and len(values) + len(named) > 1:
        for value in (*values, *named.values()):
            scope.no_effects(value, node, "a call among arguments with names")
    return values, named


def _known(scope: "Expressions", node: ast.Call, callee: Any) -> Value:
    if isinstance(callee, specials.Bound):
        if callee.function is gym.Env.reset:
            return _seeded(scope, node)
        values, named = arguments(scope, node)
        first = [] if callee.receiver is None else [callee.receiver]
        return user_call(scope, node, callee.function, callee.owner, first + values, named)
    if specials.is_special(callee):
        raise specials.refused_special(scope, node, constant(callee))
    if callee is gym.Env.reset and node.args and scope.expression(node.args[0]).fixed is specials.SELF:
        return _seeded(scope, node, 1)
    if isinstance(callee, BuiltinFunctionType) and callee in SIDE_EFFECTS:
        raise scope.refuse(node, *SIDE_EFFECTS[callee])
    module = str(getattr(callee, "__module__", None) or "")
    if isinstance(callee, MethodType | BuiltinFunctionType) and isinstance(
        getattr(callee, "__self__", None), np.random.Generator | np.random.RandomState
    ):
        raise scope.refuse(node, *MODULE_ADVICE["numpy.random"])
    if module == "gymnasium.logger":
        for argument in (*node.args, *[keyword.value for keyword in node.keywords]):
            check_pure(scope, argument)
        note_message(scope, node)
        return constant(None)
    for table in (builtin_functions.TABLE, math_functions.TABLE, numpy_functions.TABLE):
        handler = table.get(callee) if _hashable(callee) else None
        if handler is not None:
            values, named = arguments(scope, node)
            for value in (*values, *named.values()):
                if specials.is_special(value.fixed):
                    raise specials.refused_special(scope, node, value)
            result: Value = handler(scope, node, values, named)
            return result
    if isinstance(callee, np.ufunc) or module.partition(".")[0] == "numpy" or callee in numpy_functions.REFUSED:
        raise numpy_functions.refused(scope, node, callee, module)
    if module == "math":
        raise math_functions.refused(scope, node, callee)
    for prefix, (reason, advice) in MODULE_ADVICE.items():
        if module == prefix or module.startswith(prefix + "."):
            raise scope.refuse(node, reason, advice)
    if type(getattr(callee, "__self__", None)).__module__ == "random":
        raise scope.refuse(node, *MODULE_ADVICE["random"])
    if isinstance(callee, FunctionType):
        values, named = arguments(scope, node)
        return user_call(scope, node, callee, None, values, named)
    if isinstance(callee, type):
        values, named = arguments(scope, node)
        if issubclass(callee, enum.Enum) and len(values) == 1 and values[0].is_fixed:
            return scope.folded(node, callee, values[0].fixed)
        raise scope.refuse(node, f"an object of type {callee.__name__} is made", "use numbers, tuples and NumPy arrays")
    name = getattr(callee, "__name__", type(callee).__name__)
    raise scope.refuse(node, f"{name} is called", "use numbers, math, and the NumPy functions of the documentation")


def _hashable(value: Any) -> bool:
    try:
        hash(value)
    except TypeError:
        return False
    return True


def _seeded(scope: "Expressions", node: ast.Call, first: int = 0) -> Value:
    values, named = arguments(scope, node)
    values = values[first:]
    program = scope.program
    if values or set(named) - {"seed", "options"}:
        raise scope.refuse(node, "super().reset with these arguments", "write super().reset(seed=seed)")
    if program.phase != "reset" or program.depth:
        raise scope.refuse(node, "super().reset in a branch, or outside of reset", "call it first in reset")
    seed = named.get("seed")
    if seed is not None and seed.fixed is not specials.SEED:
        raise scope.refuse(node, "super().reset with another seed", "write super().reset(seed=seed)")
    program.seeded = program.seeded or seed is not None
    return constant(None)


def _space(scope: "Expressions", node: ast.Call, name: str, space: Any) -> Value:
    if name == "contains" and space is scope.program.env.action_space and len(node.args) == 1:
        if scope.expression(node.args[0]).action:
            return constant(True)
        raise scope.refuse(node, "contains() of something other than the action", "write a comparison")
    if name in ("sample", "seed"):
        raise scope.refuse(node, "a space has a random generator of its own", "draw from self.np_random")
    raise scope.refuse(node, f"the method {name} of a space", "write a comparison with its bounds")


def _of_constant(scope: "Expressions", node: ast.Call, name: str, value: Any) -> Value:
    values, named = arguments(scope, node)
    if name in CHANGING:
        kind = type(value).__name__
        raise scope.refuse(node, f"a {kind} is changed", "use a NumPy array of fixed size, with a counter")
    if all(one.is_fixed for one in (*values, *named.values())):
        result = scope.folded(node, lambda: getattr(value, name)(*[one.fixed for one in values]))
        if isinstance(value, dict) and name in ("items", "keys", "values"):
            return constant(list(result.fixed))
        return result
    if type(value) is dict and name == "get" and len(values) == 2 and values[0].is_fixed and not named:
        key, default = values
        if scope.folded(node, lambda one: one not in value, key.fixed).fixed:
            return default
    raise scope.refuse(
        node, f"the method {name} of a {type(value).__name__}", "use a NumPy array, or an index in [...]"
    )


def user_call(
    scope: "Expressions",
    node: ast.AST,
    function: Any,
    owner: type | None,
    values: list[Value],
    named: dict[str, Value],
) -> Value:
    """Returns the value of a call of a function in Python, which becomes a part of the program."""
    flags = inspect.CO_GENERATOR | inspect.CO_COROUTINE | inspect.CO_ASYNC_GENERATOR
    shown = getattr(function, "__name__", "this")
    if not isinstance(function, FunctionType) or hasattr(function, "__wrapped__"):
        raise scope.refuse(node, f"{shown} is not an ordinary function", "remove its decorators")
    if function.__code__.co_flags & flags:
        raise scope.refuse(node, f"{shown} is a generator", "write a loop")
    try:
        bound = inspect.signature(function).bind(*values, **named)
    except TypeError as error:
        raise scope.refuse(node, f"{shown} is called with wrong arguments ({error})", "correct the call") from None
    parameters: dict[str, Value] = {}
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            if bound.arguments.get(name):
                raise scope.refuse(node, f"{shown} takes any number of arguments", "name the parameters")
            parameters[name] = constant(() if parameter.kind is parameter.VAR_POSITIONAL else {})
        else:
            given = bound.arguments.get(name)
            parameters[name] = given if given is not None else constant(parameter.default)
    return scope.program.compile_call(scope, node, source_of(function), owner, parameters)
