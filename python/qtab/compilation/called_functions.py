"""The functions that an environment's methods call, and the names that they use."""

import dis
import functools
from collections.abc import Iterator
from types import CodeType, FunctionType
from typing import Any

METHODS = ("initial_state", "transition", "observe", "action_mask")
"""The methods of a functional environment that are compiled."""

LIBRARIES = ("numpy", "numba", "math")
"""Modules whose functions Numba implements itself."""


def methods_of(env: Any) -> dict[str, FunctionType]:
    """Returns the functions of ``METHODS`` that an environment has."""
    found = {name: getattr(type(env), name, None) for name in METHODS}
    return {name: function for name, function in found.items() if isinstance(function, FunctionType)}


def reachable(env: Any) -> list[FunctionType]:
    """Returns the functions of ``METHODS``, and all Python functions that they may call, each once.

    Calls are found by names: methods of the class, and functions in globals, closures and defaults.
    """
    found = list(methods_of(env).values())
    for function in found:  # grows
        for called in _called(function, type(env)):
            if called not in found:
                found.append(called)
    return found


def names_of(functions: list[FunctionType]) -> set[str]:
    """Returns the names of globals and attributes that functions use."""
    return {name for function in functions for code in codes(function.__code__) for name in code.co_names}


def codes(code: CodeType) -> Iterator[CodeType]:
    """Yields a code object and those nested in it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from codes(constant)


def helper_methods(cls: type, names: set[str]) -> dict[str, tuple[FunctionType, bool]]:
    """Returns the methods of a class among names: the function, and whether it is a static method."""
    found = {}
    for name in sorted(names):
        member = next((vars(base)[name] for base in cls.__mro__ if name in vars(base)), None)
        if isinstance(member, FunctionType):
            found[name] = member, False
        elif isinstance(member, staticmethod) and isinstance(member.__func__, FunctionType):
            found[name] = member.__func__, True
    return found


def used_values(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """Yields the globals and closed-over variables that a function uses, with their names."""
    for code in codes(function.__code__):
        for name in _globals_of(code):
            if name in function.__globals__:
                yield name, function.__globals__[name]
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            yield name, cell.cell_contents
        except ValueError:  # it is empty
            continue


@functools.cache
def _globals_of(code: CodeType) -> tuple[str, ...]:
    """Returns the names that are read as globals, in the order of their first use, without those of attributes."""
    read = [one for one in dis.get_instructions(code) if "GLOBAL" in one.opname or one.opname == "LOAD_NAME"]
    return tuple(dict.fromkeys(one.argval for one in read))


def plain(function: Any) -> FunctionType | None:
    """Returns the user's function, also of one that Numba compiles; None for other values."""
    inner = getattr(function, "py_func", function)
    if not isinstance(inner, FunctionType) or str(inner.__module__).partition(".")[0] in LIBRARIES:
        return None
    return inner


def _called(function: FunctionType, cls: type) -> Iterator[FunctionType]:
    names = names_of([function])
    if names & set(vars_of(cls)):
        for method, _ in helper_methods(cls, names).values():
            if method.__module__.partition(".")[0] not in ("gymnasium", "qtab"):
                yield method
    for _, value in used_values(function):
        called = plain(value)
        if called is not None:
            yield called


def vars_of(cls: type) -> Iterator[str]:
    """Yields the names of the members of a class and its bases."""
    for base in cls.__mro__:
        yield from vars(base)
