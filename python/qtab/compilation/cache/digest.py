"""A digest of everything that compiled code depends on: functions, the values they use, types and versions."""

import functools
import hashlib
import platform
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.versions import distribution_version
from qtab.compilation.called_functions import codes, plain, used_values

_KNOWN = ("numpy", "math", "numba", "gymnasium", "qtab")
"""Modules that are identified by their versions."""


@dataclass(frozen=True)
class Digest:
    """A digest of functions and values."""

    text: str
    unknown: tuple[Any, ...]
    """Values that are identified by their addresses only. With any, the digest holds in this process, and as long as
    they are kept."""


@dataclass
class _Seen:
    """What was found so far: the functions, numbered by their addresses, and the values without a digest."""

    functions: dict[int, int] = field(default_factory=dict)
    unknown: list[Any] = field(default_factory=list)


def digest_of(functions: dict[str, FunctionType], others: Any) -> Digest:
    """Returns a digest of functions by name, of the values they use and the functions they call, and of other values.

    The digest covers line numbers, because messages contain them, but not the names of files.

    Args:
        functions: The functions.
        others: Any nesting of numbers, texts, arrays, tuples, lists and dicts.
    """
    seen = _Seen()
    parts = [_environment(), _value(others, seen), _value(functions, seen)]
    return Digest(hashlib.sha256(repr(parts).encode()).hexdigest()[:32], tuple(seen.unknown))


@functools.cache
def _environment() -> tuple[str, ...]:
    import llvmlite
    import llvmlite.binding as llvm

    versions = [distribution_version(), np.__version__, llvmlite.__version__, numba_version()]
    machine = [llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()]
    return sys.version, platform.machine(), _own_code(), *versions, *machine


def _own_code() -> str:
    """Returns a digest of this package, which may change without a new version while it is developed."""
    files = sorted(Path(__file__).parent.parent.rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


@functools.cache
def numba_version() -> str:
    """Returns the version of Numba without its import, which takes longer than all else when code is loaded."""
    from importlib.metadata import version

    return version("numba")


def _value(value: Any, seen: _Seen) -> Any:
    if isinstance(value, np.ndarray | np.void):
        return _array(value, seen)
    if isinstance(value, bool | int | float | complex | str | bytes | type(None) | np.generic):
        return [type(value).__name__, repr(value)]
    if isinstance(value, np.dtype):
        return ["dtype", repr(value)]
    if isinstance(value, tuple | list | frozenset):
        items = sorted(value, key=repr) if isinstance(value, frozenset) else value
        return [type(value).__name__, [_value(item, seen) for item in items]]
    if isinstance(value, dict):
        return ["dict", [[_value(key, seen), _value(item, seen)] for key, item in value.items()]]
    if (function := plain(value)) is not None:
        return _function(function, seen)
    if isinstance(value, type):
        return _class(value, seen)
    if isinstance(value, ModuleType) and _root(value) in (*_KNOWN, *sys.stdlib_module_names):
        return ["module", value.__name__]
    if callable(value) and getattr(value, "__module__", None) is not None and hasattr(value, "__name__"):
        root = str(value.__module__).partition(".")[0]
        if root in _KNOWN or root == "builtins":
            return ["callable", value.__module__, value.__name__]
    name = str(getattr(value, "__name__", ""))
    if isinstance(value, np.ufunc) and getattr(np, name, None) is value:
        return ["ufunc", name]
    return _unknown(value, seen)


def _array(value: NDArray[Any] | np.void, seen: _Seen) -> Any:
    if value.dtype.hasobject:
        return _unknown(value, seen)
    # Not its text, which leaves out most numbers of long arrays.
    return ["array", str(value.dtype), value.shape, hashlib.sha256(value.tobytes()).hexdigest()]


def _unknown(value: Any, seen: _Seen) -> Any:
    seen.unknown.append(value)
    return ["unknown", id(value)]


def _function(function: FunctionType, seen: _Seen) -> Any:
    if id(function) in seen.functions:
        return ["seen", seen.functions[id(function)]]
    seen.functions[id(function)] = len(seen.functions)
    defaults = [_value(function.__defaults__, seen), _value(function.__kwdefaults__, seen)]
    used: list[Any] = [function.__qualname__, _code(function.__code__), defaults]
    attributes = frozenset(name for code in codes(function.__code__) for name in code.co_names)
    for name, value in used_values(function):
        used.append([name, _used(value, attributes, seen, ())])
    return used


def _used(value: Any, attributes: frozenset[str], seen: _Seen, inside: tuple[str, ...]) -> Any:
    """Returns a value; of modules that may change without a new version, the attributes with these names."""
    if not isinstance(value, ModuleType) or _root(value) in (*_KNOWN, *sys.stdlib_module_names):
        return _value(value, seen)
    name = value.__name__
    if name in inside:
        return ["module", name]
    found = sorted(attributes & vars(value).keys())
    return ["module", name, [[one, _used(vars(value)[one], attributes, seen, (*inside, name))] for one in found]]


def _root(module: ModuleType) -> str:
    return module.__name__.partition(".")[0]


def _class(cls: type, seen: _Seen) -> Any:
    root = cls.__module__.partition(".")[0]
    if root in (*_KNOWN, "builtins"):
        return ["class", cls.__module__, cls.__qualname__]
    if hasattr(cls, "_fields"):
        return ["namedtuple", cls.__qualname__, list(cls._fields)]
    if hasattr(cls, "__members__"):  # an enumeration
        return ["enum", cls.__qualname__, [[name, repr(one.value)] for name, one in cls.__members__.items()]]
    # A class whose constants are used, or the environment's: numbers only, since compiled code sees no others.
    numbers = {name: one for name, one in sorted(vars(cls).items()) if isinstance(one, bool | int | float)}
    return ["class", cls.__qualname__, _value(numbers, seen)]


def _code(code: CodeType) -> list[Any]:
    constants = [_code(one) if isinstance(one, CodeType) else repr(one) for one in code.co_consts]
    names = [*code.co_names, *code.co_varnames, *code.co_freevars, *code.co_cellvars]
    flags = [code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags, code.co_firstlineno]
    return [code.co_code.hex(), code.co_linetable.hex(), constants, names, flags]
