"""Comparison of states, by value, and the numbers in them that grow."""

import math
from collections.abc import Hashable, Iterator, Mapping, Sequence
from enum import Enum
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType, SimpleNamespace
from typing import Any, Generic

import gymnasium as gym
import numpy as np

from qtab._utils.shown import counted, shown
from qtab.envs.tabulation.generator import ListingGenerator
from qtab.envs.tabulation.uniform import Uniform

_CONSTANT = (type, ModuleType, Enum, type(None), str, bytes)
"""Objects that do not change in an episode."""

_COMPARED_BY_VALUE = (int, float, str, bytes, tuple, list, set, frozenset, Mapping, np.ndarray)
"""Values of which only the number, the text or the items are compared, not the attributes of a subclass."""

_IN_ATTRIBUTES = (object, Generic, SimpleNamespace)
"""Classes written in C whose objects keep nothing besides their attributes."""

_DEEPEST = 4
"""The depth to which the attributes of objects are searched for growing numbers."""


class NotComparableError(ValueError):
    """Raised for a part of a state that cannot be compared with that of another state. The message describes it."""


def state_key(state: Any, name: str = "state") -> Hashable:
    """Returns a hashable value that is equal for equal states of a functional environment.

    Numbers are compared by value and arrays by dtype, shape and bytes. Tuples, lists and dicts are compared by their
    items, and dataclasses and other objects written in Python by their attributes.

    Args:
        state: The state.
        name: Its name in messages.

    Raises:
        NotComparableError: for any other object, a NaN, or a state that contains itself.
    """
    try:
        return _key(state, name, None)
    except RecursionError:
        raise NotComparableError(f"{name} contains itself") from None


def attributes_key(owner: Any, attributes: Mapping[str, Any]) -> Hashable:
    """Returns a hashable value that is equal for equal attributes of copies of an object.

    They are compared as in :func:`state_key`, and two attributes that are one object differ from two equal objects.

    Args:
        owner: The object, to which its attributes may refer.
        attributes: Its attributes by their names.

    Raises:
        NotComparableError: for an attribute that cannot be compared, or is NaN.
    """
    seen = {id(owner): 0}
    return tuple((name, _key(value, f"self.{name}", seen)) for name, value in sorted(attributes.items()))


def _key(value: Any, name: str, seen: dict[int, int] | None) -> Hashable:
    """Returns the key of a value; see :func:`state_key`.

    Args:
        value: The value.
        name: Its name in messages.
        seen: A number for each object that can change, by its id; None to compare objects by value only.
    """
    if isinstance(value, _COMPARED_BY_VALUE) and not isinstance(value, Enum) and getattr(value, "__dict__", None):
        raise NotComparableError(f"{name} is a {type(value).__qualname__} with attributes of its own")
    if isinstance(value, bool | int | np.bool_ | np.integer):
        return value
    if isinstance(value, float | np.floating):
        if math.isnan(value):
            raise NotComparableError(f"{name} is NaN")
        # A zero with a sign differs from one without, in quotients and in atan2.
        return "-0.0" if value == 0 and math.copysign(1.0, value) < 0 else float(value)
    if isinstance(value, Uniform):
        value.refuse(f"kept in {name}")
    if isinstance(value, tuple):
        return (type(value), *(_key(item, f"{name}[{index}]", seen) for index, item in enumerate(value)))
    if isinstance(value, ListingGenerator):  # the generator of the environment
        return "the generator"
    if isinstance(value, gym.Space):
        bounds = (getattr(value, side, None) for side in ("low", "high"))
        return repr(value), *(bound.tobytes() for bound in bounds if isinstance(bound, np.ndarray))
    if isinstance(value, _CONSTANT):
        return type(value), value
    if seen is not None:
        number = seen.get(id(value))
        if number is not None:
            return "the object", number
        seen[id(value)] = len(seen)
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, list):
        return (list, *(_key(item, f"{name}[{index}]", seen) for index, item in enumerate(value)))
    if isinstance(value, set | frozenset):
        return type(value), frozenset(_key(item, f"an item of {name}", seen) for item in value)
    if isinstance(value, Mapping):
        pairs = value.items()
        keys = [(_key(key, f"a key of {name}", seen), _key(item, f"{name}[{key!r}]", seen)) for key, item in pairs]
        return (type(value), *keys)
    return _key_of_object(value, name, seen)


def _key_of_object(value: Any, name: str, seen: dict[int, int] | None) -> Hashable:
    cls = type(value)
    if isinstance(value, np.random.Generator | np.random.RandomState):
        raise NotComparableError(f"{name} is another random generator than the one that the environment is given")
    if isinstance(value, MethodType):
        return cls, value.__func__, _key(value.__self__, f"{name}.__self__", seen)
    if isinstance(value, FunctionType):
        if value.__closure__:
            raise NotComparableError(f"{name} is a function with variables of another function, which are not copied")
        return value
    if not hasattr(value, "__dict__") or cls.__module__.partition(".")[0] in ("gymnasium", "numpy", "random"):
        raise NotComparableError(f"{name} is a {cls.__module__}.{cls.__qualname__}, which cannot be compared")
    if (reason := part_outside_attributes(cls)) is not None:
        raise NotComparableError(f"{name} is a {cls.__qualname__}, {reason}")
    return (cls, *((key, _key(item, f"{name}.{key}", seen)) for key, item in sorted(vars(value).items())))


def part_outside_attributes(cls: type) -> str | None:
    """Returns why ``vars`` does not hold the whole state of the objects of a class, in words; None if it does."""
    for base in cls.__mro__:
        slots = vars(base).get("__slots__", ())
        if set((slots,) if isinstance(slots, str) else slots) - {"__dict__", "__weakref__"}:
            return f"whose base {base.__qualname__} has __slots__" if base is not cls else "which has __slots__"
        if isinstance(vars(base).get("__new__"), BuiltinFunctionType) and base not in _IN_ATTRIBUTES:
            return f"with the base {base.__qualname__} written in C, which may keep a state that cannot be seen"
    return None


def growing_numbers(states: Sequence[Any], name: str = "state") -> str:
    """Returns the numbers of the states that still had new values in the later half of them, in words; or ``""``."""
    half = len(states) // 2
    earlier: dict[str, set[float]] = {}
    later: dict[str, set[float]] = {}
    for index, state in enumerate(states):
        known = earlier if index < half else later
        for where, number in _numbers(state, name):
            known.setdefault(where, set()).add(number)
    counts = {where: len(values - earlier.get(where, set())) for where, values in later.items()}
    growing = sorted((where for where in counts if counts[where] > 1), key=lambda where: -counts[where])
    return ", ".join(_range(where, earlier.get(where, set()) | later[where]) for where in growing[:3])


def _range(where: str, values: set[float]) -> str:
    return f"{where} ({counted(len(values), 'value')} from {min(values):g} to {max(values):g})"


def _numbers(value: Any, name: str) -> Iterator[tuple[str, float]]:
    if isinstance(value, bool | int | float | np.number | np.bool_):
        yield name, float(value)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "iufb":
        for index, number in np.ndenumerate(value):
            yield f"{name}[{', '.join(map(str, index))}]", float(number)
    elif isinstance(value, tuple | list):
        for position, item in enumerate(value):
            yield from _numbers(item, f"{name}[{position}]")
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from _numbers(item, f"{name}[{key!r}]")
    elif hasattr(value, "__dict__") and not isinstance(value, (*_CONSTANT, gym.Space)) and name.count(".") < _DEEPEST:
        for key, item in vars(value).items():
            yield from _numbers(item, f"{name}.{key}")


def state_text(state: Any) -> str:
    """Returns a state as text: its numbers as Python writes them."""
    return shown(_plain(state))


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if type(value) in (tuple, list):
        return type(value)(map(_plain, value))
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return value
