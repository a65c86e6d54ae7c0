"""Digests of the code of classes and functions, and checks for replaced code of a library.

They are digests of byte code, not of source: byte code exists without a file, it is the code that runs even if the
file was edited since, and comments and formatting do not change it. It differs between versions of Python.
"""

import dis
import functools
import hashlib
import inspect
import sys
from collections.abc import Iterator
from itertools import chain
from types import (
    BuiltinFunctionType,
    ClassMethodDescriptorType,
    CodeType,
    FunctionType,
    MethodDescriptorType,
    WrapperDescriptorType,
)
from typing import Any

import numpy as np
from gymnasium.envs.registration import load_env_creator

LIBRARY = "library"
"""The digest of the code of Gymnasium and of this package, which their versions identify."""
_LIBRARIES = ("gymnasium", "qtab")
_PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"


def class_code(cls: type) -> str | None:
    """Returns a digest of the code of a class and of its bases outside Gymnasium and qtab; ``LIBRARY`` without any.

    A method of Gymnasium's or qtab's classes that was replaced counts as well.
    """
    parts = []
    for base in cls.__mro__:
        if not is_of_library(base):
            if base.__module__.partition(".")[0] not in sys.stdlib_module_names:
                parts.append(_members(base))
        elif (name := replaced_member(base)) is not None:
            replaced = inspect.getattr_static(base, name, None)
            parts.append([name, [_of_function(one) for one in _functions(replaced)]])
    return _digest(parts) if parts else LIBRARY


def function_code(function: Any) -> str:
    """Returns a digest of the code of a function, with its defaults and the values that it closes over."""
    return _digest(_of_function(function))


def is_of_library(cls: type) -> bool:
    """Returns whether a class is one of Gymnasium's or of this package's."""
    return cls.__module__.partition(".")[0] in _LIBRARIES


def changed_library_code(cls: type) -> str | None:
    """Returns the name of replaced code in a class of Gymnasium or this package; None if there is none.

    A test or a lesson may replace a method of the class or of its bases, or a function of their modules.
    """
    for base in filter(is_of_library, cls.__mro__):
        if (name := replaced_member(base)) is not None:
            return f"{base.__qualname__}.{name}"
        for name, value in vars(sys.modules[base.__module__]).items():
            if type(value) is FunctionType and not _is_trusted(value):
                return f"{base.__module__}.{name}"
    return None


def changed_entry_point(entry_point: str) -> str | None:
    """Returns the name of replaced code in the class or the function of an entry point; None if there is none."""
    made: Any = load_env_creator(entry_point)
    if f"{getattr(made, '__module__', '')}:{getattr(made, '__qualname__', '')}" != entry_point:
        return entry_point
    return changed_library_code(made) if isinstance(made, type) else None


def replaced_member(cls: type) -> str | None:
    """Returns the name of a method that is not defined in the module of its class; None if there is none.

    A function's globals show where it was defined; its name and module can be copied from the function it replaces.
    """
    module = sys.modules.get(cls.__module__)
    if module is None or cls.__module__ == "qtab._core":
        return None
    own = vars(module)
    for name, member in vars(cls).items():
        if type(member) is FunctionType and member.__globals__ is own:
            continue
        functions = _functions(member)
        for function in functions:
            if function.__globals__ is not own and not _is_trusted(function):
                return name
        if not functions and callable(member) and not isinstance(member, type) and not _is_builtin(member):
            return name
    return None


def _is_trusted(function: FunctionType) -> bool:
    root = str(function.__globals__.get("__name__", "")).partition(".")[0]
    return root in _LIBRARIES or (root in sys.stdlib_module_names and root != "__main__")


def _is_builtin(member: Any) -> bool:
    kinds = (BuiltinFunctionType, ClassMethodDescriptorType, MethodDescriptorType, WrapperDescriptorType)
    return isinstance(member, kinds)


def _functions(member: Any) -> list[FunctionType]:
    """Returns the functions of a member of a class: a method, those of a property, or none."""
    if isinstance(member, property):
        candidates = [member.fget, member.fset, member.fdel]
    else:
        candidates = [getattr(member, "__func__", None), getattr(member, "func", None), member]
    return [function for function in candidates if isinstance(function, FunctionType)]


def _members(cls: type) -> list[Any]:
    stored = set(_stored_attributes(cls))
    parts: list[Any] = [cls.__qualname__.rpartition(".")[2]]
    for name, member in sorted(vars(cls).items()):
        functions = _functions(member)
        if functions:
            parts.append([name, [_of_function(function) for function in functions]])
        elif not name.startswith("__") and name not in stored and _is_constant(member):
            parts.append([name, _constant(member)])
    return parts


def _stored_attributes(cls: type) -> Iterator[str]:
    """Yields the attributes that a method assigns; a class attribute of such a name is not a constant."""
    for member in vars(cls).values():
        for function in _functions(member):
            yield from _stored(function.__code__)


@functools.lru_cache(maxsize=4096)
def _stored(code: CodeType) -> frozenset[str]:
    """Returns the attributes that code assigns, without those of the functions that it defines.

    Code never changes, and each run reads that of Gymnasium's base classes: without the cache, this takes 3 ms a run.
    """
    return frozenset(one.argval for one in dis.get_instructions(code) if one.opname == "STORE_ATTR")


def state_attributes(cls: type) -> set[str]:
    """Returns the attributes that a class assigns when it is reset, stepped, rendered or closed.

    They are its state, not part of the problem. Methods that these methods call count as well.
    """
    assigned: set[str] = set()
    names = ["reset", "step", "render", "close"]
    for name in names:  # grows by the methods that are called
        members = [vars(base)[name] for base in cls.__mro__ if name in vars(base)]
        for function in chain.from_iterable(map(_functions, members)):
            for code in _nested(function.__code__):
                assigned |= _stored(code)
                names += sorted({*code.co_names} - _stored(code) - {*names})
    return assigned


def _nested(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _nested(constant)


def _is_constant(value: Any) -> bool:
    return isinstance(value, bool | int | float | str | tuple | type(None))


def _of_function(function: FunctionType) -> list[Any]:
    cells = [_captured(cell) for cell in function.__closure__ or ()]
    defaults = [function.__defaults__, sorted((function.__kwdefaults__ or {}).items())]
    code = function.__code__
    # Constants of the module, by their names in capitals.
    constants = {name: function.__globals__.get(name) for name in code.co_names if name.isupper()}
    known = [(name, _constant(value)) for name, value in sorted(constants.items()) if _is_constant(value)]
    return [_of_code(code, function.__doc__), _constant(defaults), cells, known]


def _captured(cell: Any) -> Any:
    try:
        value = cell.cell_contents
    except ValueError:  # it is empty
        return None
    return _of_code(value.__code__, value.__doc__) if isinstance(value, FunctionType) else _constant(value)


def _of_code(code: CodeType, docstring: str | None = None) -> list[Any]:
    constants = [_constant(value) for value in code.co_consts]
    if constants and docstring is not None and isinstance(code.co_consts[0], str):
        constants[0] = _constant(None)
    names = [*code.co_names, *code.co_varnames, *code.co_freevars, *code.co_cellvars]
    return [code.co_code.hex(), constants, names, code.co_argcount, code.co_kwonlyargcount, code.co_flags]


def _constant(value: Any) -> Any:
    if isinstance(value, CodeType):
        return _of_code(value)
    if isinstance(value, list | tuple):
        return [type(value).__name__, *map(_constant, value)]
    if isinstance(value, frozenset):
        return ["frozenset", *sorted(map(repr, value))]
    if isinstance(value, dict):
        return ["dict", *([_constant(key), _constant(part)] for key, part in value.items())]
    if isinstance(value, np.ndarray | np.generic) and not value.dtype.hasobject:
        return [value.dtype.str, value.shape, value.tobytes().hex()]
    if isinstance(value, bool | int | float | complex | str | bytes | type(None)):
        return repr(value)
    return f"{type(value).__module__}:{type(value).__qualname__}"


def _digest(parts: Any) -> str:
    return f"{_PYTHON}:{hashlib.sha256(repr(parts).encode()).hexdigest()[:32]}"
