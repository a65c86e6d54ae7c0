"""Data without effects: numbers, texts, arrays, and collections of them."""

import dataclasses
import enum
from collections import deque
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

from qtab.compilation.twins.own_code import has_own_code, is_computed

_SIMPLE = (bool, int, float, complex, str, bytes, type(None), range, slice)
_COLLECTIONS = (list, tuple, set, frozenset, deque)


def is_plain(value: Any) -> bool:
    """Returns whether a value is data that can be copied, read and changed without any effect elsewhere.

    Spaces and generators are data, too: a copy of them draws the same numbers, and leaves the original as it is.
    """
    return _is_plain(value, set())


def _is_plain(value: Any, seen: set[int]) -> bool:
    if type(value) in _SIMPLE or isinstance(value, np.generic | np.dtype | enum.Enum):
        return True
    if id(value) in seen:
        return True
    seen.add(id(value))
    if type(value) is np.ndarray:
        return not value.dtype.hasobject
    is_named = isinstance(value, tuple) and hasattr(value, "_fields")
    if type(value) in _COLLECTIONS or (is_named and not has_own_code(type(value))):
        return all(_is_plain(item, seen) for item in value)
    if isinstance(value, dict):
        return type(value).__module__ in ("builtins", "collections") and _are_plain(value, seen)
    if isinstance(value, np.random.Generator) or _is_of_gymnasium(value):
        return True
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        members = [member for base in type(value).__mro__[:-1] for member in vars(base).values()]
        if has_own_code(type(value)) or any(map(is_computed, members)):
            return False
        return _are_plain(_fields_of(value), seen)
    return False


def mutable_parts(value: Any) -> Iterator[Any]:
    """Yields the arrays, lists, dicts, sets and deques in data, outer ones first."""
    if isinstance(value, np.ndarray | list | dict | set | deque):
        yield value
    inner: list[Any] = []
    if isinstance(value, dict):
        inner = list(value.values())
    elif isinstance(value, list | tuple | deque):
        inner = list(value)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        inner = list(_fields_of(value).values())
    for one in inner:
        yield from mutable_parts(one)


def shared_attributes(env: Any, outside: list[Any]) -> dict[str, str]:
    """Returns the attributes of an environment that share memory, and what with: an attribute, or a value outside.

    Args:
        env: The environment.
        outside: The arrays and collections of its class and of modules that its methods read.
    """
    parts = [(f"self.{name}", part) for name, value in vars(env).items() for part in mutable_parts(value)]
    for name, value in vars(env).items():
        if not is_plain(value):  # such as an object of a class of one's own
            inner = getattr(value, "__dict__", {}).values()
            parts += [(f"self.{name}", part) for one in inner for part in mutable_parts(one)]
    others = [*parts, *(("a value outside of the environment", one) for one in outside)]
    found: dict[str, str] = {}
    for name, one in parts:
        for other, part in others:
            if other != name and (one is part or _overlap(one, part)):
                found.setdefault(name.removeprefix("self."), other)
    return found


def _overlap(one: Any, other: Any) -> bool:
    return isinstance(one, np.ndarray) and isinstance(other, np.ndarray) and np.may_share_memory(one, other)


def _fields_of(value: Any) -> dict[str, Any]:
    """Returns the values of the fields of a dataclass, also of one with slots, and those beside them."""
    fields = {one.name: getattr(value, one.name) for one in dataclasses.fields(value) if hasattr(value, one.name)}
    return {**fields, **getattr(value, "__dict__", {})}


def _are_plain(values: Mapping[Any, Any], seen: set[int]) -> bool:
    return all(_is_plain(key, seen) and _is_plain(item, seen) for key, item in values.items())


def _is_of_gymnasium(value: Any) -> bool:
    return isinstance(value, spaces.Space) and type(value).__module__.partition(".")[0] == "gymnasium"


def same(one: Any, other: Any) -> bool:
    """Returns whether two values are the same data, to the bit."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())
    if isinstance(one, dict):
        return same(list(one.items()), list(other.items()))
    if isinstance(one, list | tuple | deque):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, set | frozenset):
        return bool(one == other)
    if dataclasses.is_dataclass(one):
        return same(_fields_of(one), _fields_of(other))
    if _is_of_gymnasium(one):
        return same(vars(one), vars(other))
    return repr(one) == repr(other)
