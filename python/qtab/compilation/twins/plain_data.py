"""Data without effects: numbers, texts, arrays, and collections of them."""

import dataclasses
import enum
from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

_SIMPLE = (bool, int, float, complex, str, bytes, type(None), range, slice, np.generic, np.dtype, enum.Enum)
_COLLECTIONS = (list, tuple, set, frozenset, deque)


def is_plain(value: Any) -> bool:
    """Returns whether a value is data that can be copied, read and changed without any effect elsewhere.

    Spaces and generators are data, too: a copy of them draws the same numbers, and leaves the original as it is.
    """
    return _is_plain(value, set())


def _is_plain(value: Any, seen: set[int]) -> bool:
    if isinstance(value, _SIMPLE):
        return True
    if id(value) in seen:
        return True
    seen.add(id(value))
    if isinstance(value, np.ndarray):
        return not value.dtype.hasobject
    if type(value) in _COLLECTIONS or (isinstance(value, tuple) and hasattr(value, "_fields")):
        return all(_is_plain(item, seen) for item in value)
    if isinstance(value, dict):
        return type(value).__module__ in ("builtins", "collections") and _are_plain(value, seen)
    if isinstance(value, np.random.Generator) or _is_of_gymnasium(value):
        return True
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return "__deepcopy__" not in vars(type(value)) and _are_plain(vars(value), seen)
    return False


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
    if dataclasses.is_dataclass(one) or _is_of_gymnasium(one):
        return same(vars(one), vars(other))
    return repr(one) == repr(other)
