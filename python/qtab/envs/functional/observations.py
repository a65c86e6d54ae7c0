"""Observations of a functional environment: converted to their space, and checked to lie in it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._utils.shown import counted, shown


def observation_in(space: Any, value: Any, name: str) -> Any:
    """Returns the observation that ``observe`` returned, as an element of the observation space.

    Arrays are copied, so that the caller may change them.

    Args:
        space: The observation space.
        value: The returned value: a number for a Discrete space; numbers in tuples, lists or arrays for a Box, a
            MultiDiscrete or a MultiBinary space; a tuple of the observations of its parts for a Tuple or a Dict space,
            in the order of the space, or a dict.
        name: The name of the value in messages, such as ``"observe of Walk"``.

    Raises:
        TypeError: if it holds other values than numbers, or floats for a space of integers.
        ValueError: if it has another shape, or lies outside the space.
    """
    if isinstance(space, spaces.Discrete):
        number = _integer(value, name)
        if not 0 <= number - int(space.start) < int(space.n):
            raise _outside(space, value, name)
        return number
    if isinstance(space, spaces.Box | spaces.MultiDiscrete | spaces.MultiBinary):
        array = _array(space, value, name)
        inside = _in_box(space, array) if isinstance(space, spaces.Box) else space.contains(array)
        if not inside:
            raise _outside(space, value, name)
        return array
    if isinstance(space, spaces.Tuple):
        parts = _parts(value, len(space.spaces), name)
        return tuple(
            observation_in(part, given, f"{name}, part {index},")
            for index, (part, given) in enumerate(zip(space.spaces, parts, strict=True))
        )
    if isinstance(space, spaces.Dict):
        if isinstance(value, Mapping):
            if value.keys() != space.spaces.keys():
                raise ValueError(f"{name} must return the keys {list(space.spaces)}, got {list(value)}")
            given = [value[key] for key in space.spaces]
        else:
            given = list(_parts(value, len(space.spaces), name))
        return {
            key: observation_in(part, one, f"{name}, part {key!r},")
            for (key, part), one in zip(space.spaces.items(), given, strict=True)
        }
    if not space.contains(value):
        raise _outside(space, value, name)
    return value


def _integer(value: Any, name: str) -> int:
    if isinstance(value, bool | np.bool_):
        return int(value)
    try:
        return int(value.__index__())
    except (AttributeError, TypeError):
        raise TypeError(f"{name} must return an integer, got {shown(value)}") from None


def _array(space: Any, value: Any, name: str) -> NDArray[Any]:
    try:
        if space.dtype.kind == "f":
            array = np.array(value, space.dtype)
        else:
            given = np.asarray(value)
            if given.dtype.kind not in "iub":
                raise TypeError
            array = np.array(value, space.dtype)
    except OverflowError:
        raise _outside(space, value, name) from None
    except (TypeError, ValueError):
        kind = "numbers" if space.dtype.kind == "f" else "integers"
        raise TypeError(f"{name} must return {kind} in an array, a tuple or a list, got {shown(value)}") from None
    if array.shape == () and space.shape == (1,):
        array = array.reshape(1)
    if array.shape != space.shape:
        raise ValueError(
            f"{name} must return an array of shape {space.shape}, the observation space's, got one of {array.shape}"
        )
    return array


def _in_box(space: spaces.Box, array: NDArray[Any]) -> bool:
    return bool((array >= space.low).all() and (array <= space.high).all())


def _parts(value: Any, count: int, name: str) -> tuple[Any, ...]:
    if not isinstance(value, tuple | list) or len(value) != count:
        raise ValueError(f"{name} must return a tuple of {counted(count, 'part')}, got {shown(value)}")
    return tuple(value)


def _outside(space: Any, value: Any, name: str) -> ValueError:
    return ValueError(f"{name} must return an element of {' '.join(str(space).split())}, got {shown(value)}")
