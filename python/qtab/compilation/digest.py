"""A digest of everything that compiled code depends on: functions, the values they use, types and versions."""

import functools
import hashlib
import platform
import sys
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from qtab._utils.versions import distribution_version
from qtab.compilation.functions import codes, plain, used_values

_KNOWN = ("numpy", "math", "numba", "gymnasium", "qtab")
"""Modules that are identified by their versions."""


class Unknown(Exception):  # noqa: N818 - it only means that the code cannot be stored
    """A value has no digest."""


def digest_of(functions: dict[str, FunctionType], others: Any) -> str:
    """Returns a digest of functions by name, of the values they use and the functions they call, and of other values.

    The digest covers line numbers, because messages contain them, but not the names of files.

    Args:
        functions: The functions.
        others: Any nesting of numbers, texts, arrays, tuples, lists and dicts.

    Raises:
        Unknown: if a value that is used has no digest.
    """
    visited: dict[int, int] = {}
    parts = [_environment(), _value(others, visited), _value(functions, visited)]
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]


@functools.cache
def _environment() -> tuple[str, ...]:
    import llvmlite
    import llvmlite.binding as llvm

    versions = [distribution_version(), np.__version__, llvmlite.__version__, _numba_version()]
    machine = [llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()]
    return sys.version, platform.machine(), _own_code(), *versions, *machine


def _own_code() -> str:
    """Returns a digest of this package, which may change without a new version while it is developed."""
    files = sorted(Path(__file__).parent.rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


def _numba_version() -> str:
    # Without the import of numba, which takes longer than everything else when compiled code is loaded.
    from importlib.metadata import version

    return version("numba")


def _value(value: Any, visited: dict[int, int]) -> Any:
    if isinstance(value, bool | int | float | complex | str | bytes | type(None) | np.generic):
        return [type(value).__name__, repr(value)]
    if isinstance(value, np.dtype):
        return ["dtype", repr(value)]
    if isinstance(value, tuple | list | frozenset):
        items = sorted(value, key=repr) if isinstance(value, frozenset) else value
        return [type(value).__name__, [_value(item, visited) for item in items]]
    if isinstance(value, dict):
        return ["dict", [[_value(key, visited), _value(item, visited)] for key, item in value.items()]]
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufc":
        return ["array", str(value.dtype), value.shape, hashlib.sha256(value.tobytes()).hexdigest()]
    if (function := plain(value)) is not None:
        return _function(function, visited)
    if isinstance(value, type):
        return _class(value, visited)
    if isinstance(value, ModuleType) and _root(value) in (*_KNOWN, *sys.stdlib_module_names):
        return ["module", value.__name__]
    if callable(value) and getattr(value, "__module__", None) is not None and hasattr(value, "__name__"):
        root = str(value.__module__).partition(".")[0]
        if root in _KNOWN or root == "builtins":
            return ["callable", value.__module__, value.__name__]
    if type(value).__module__.partition(".")[0] == "numpy":  # a ufunc
        return ["numpy", repr(value)]
    raise Unknown(type(value).__name__)


def _function(function: FunctionType, visited: dict[int, int]) -> Any:
    if id(function) in visited:
        return ["seen", visited[id(function)]]
    visited[id(function)] = len(visited)
    defaults = [_value(function.__defaults__, visited), _value(function.__kwdefaults__, visited)]
    used: list[Any] = [function.__qualname__, _code(function.__code__), defaults]
    attributes = frozenset(name for code in codes(function.__code__) for name in code.co_names)
    for name, value in used_values(function):
        used.append([name, _used(value, attributes, visited, ())])
    return used


def _used(value: Any, attributes: frozenset[str], visited: dict[int, int], inside: tuple[str, ...]) -> Any:
    """Returns a value; of modules that may change without a new version, the attributes with these names."""
    if not isinstance(value, ModuleType) or _root(value) in (*_KNOWN, *sys.stdlib_module_names):
        return _value(value, visited)
    name = value.__name__
    if name in inside:
        return ["module", name]
    found = sorted(attributes & vars(value).keys())
    return ["module", name, [[one, _used(vars(value)[one], attributes, visited, (*inside, name))] for one in found]]


def _root(module: ModuleType) -> str:
    return module.__name__.partition(".")[0]


def _class(cls: type, visited: dict[int, int]) -> Any:
    root = cls.__module__.partition(".")[0]
    if root in (*_KNOWN, "builtins"):
        return ["class", cls.__module__, cls.__qualname__]
    if hasattr(cls, "_fields"):
        return ["namedtuple", cls.__qualname__, list(cls._fields)]
    if hasattr(cls, "__members__"):  # an enumeration
        return ["enum", cls.__qualname__, [[name, repr(one.value)] for name, one in cls.__members__.items()]]
    # A class whose constants are used, or the environment's: numbers only, since compiled code sees no others.
    numbers = {name: one for name, one in sorted(vars(cls).items()) if isinstance(one, bool | int | float)}
    return ["class", cls.__qualname__, _value(numbers, visited)]


def _code(code: CodeType) -> list[Any]:
    constants = [_code(one) if isinstance(one, CodeType) else repr(one) for one in code.co_consts]
    names = [*code.co_names, *code.co_varnames, *code.co_freevars, *code.co_cellvars]
    flags = [code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags, code.co_firstlineno]
    return [code.co_code.hex(), code.co_linetable.hex(), constants, names, flags]
