"""Comparison of states, by value, and the numbers in them that grow."""

import math
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils.shown import counted, shown
from qtab.envs.tabulation.uniform import Uniform

_CONSTANT = (type, FunctionType, BuiltinFunctionType, MethodType, ModuleType, gym.Space, Enum, type(None), str, bytes)
"""Objects without numbers that change in an episode."""


class NotComparableError(ValueError):
    """Raised for a part of a state that cannot be compared with that of another state. The message describes it."""


def state_key(state: Any, name: str = "state") -> Any:
    """Returns a hashable value that is equal for equal states.

    Numbers are compared by value and arrays by dtype, shape and bytes. Tuples, lists and dicts are compared by their
    items, and dataclasses and other objects written in Python by their attributes.

    Args:
        state: The state.
        name: Its name in messages.

    Raises:
        NotComparableError: for any other object, a NaN, or a state that contains itself.
    """
    try:
        return _key(state, name)
    except RecursionError:
        raise NotComparableError(f"{name} contains itself") from None


def _key(value: Any, name: str) -> Any:
    if isinstance(value, bool | int | np.bool_ | np.integer):
        return value
    if isinstance(value, float | np.floating):
        if math.isnan(value):
            raise NotComparableError(f"{name} is NaN")
        # A zero with a sign differs from one without, in quotients and in atan2.
        return "-0.0" if value == 0 and math.copysign(1.0, value) < 0 else value
    if isinstance(value, Uniform):
        value.refuse(f"kept in {name}")
    if isinstance(value, tuple):
        return (type(value), *(_key(item, f"{name}[{index}]") for index, item in enumerate(value)))
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, _CONSTANT):
        return value
    if isinstance(value, list):
        return (list, *(_key(item, f"{name}[{index}]") for index, item in enumerate(value)))
    if isinstance(value, set | frozenset):
        return type(value), frozenset(_key(item, f"an item of {name}") for item in value)
    if isinstance(value, Mapping):
        items = value.items()
        return (type(value), *((_key(key, f"a key of {name}"), _key(item, f"{name}[{key!r}]")) for key, item in items))
    return _key_of_object(value, name)


def _key_of_object(value: Any, name: str) -> Any:
    cls = type(value)
    if isinstance(value, np.random.Generator | np.random.RandomState):
        raise NotComparableError(f"{name} is another random generator than the one that the environment is given")
    if not hasattr(value, "__dict__") or cls.__module__.partition(".")[0] in ("gymnasium", "numpy", "random"):
        raise NotComparableError(f"{name} is a {cls.__module__}.{cls.__qualname__}, which cannot be compared")
    return (cls, *((key, _key(item, f"{name}.{key}")) for key, item in sorted(vars(value).items())))


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
    elif hasattr(value, "__dict__") and not isinstance(value, _CONSTANT):
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
    return value
