"""Observations in words, for environments with a known meaning."""

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.envs.quantities import Quantities

_PLACES = ("red", "green", "yellow", "blue")


def state_in_words(known: Quantities, observation: Any, columns: int | None = None) -> str:
    """Returns an observation in words: its components by name, or a place on a map with ``columns`` columns."""
    if columns is not None:
        return f"row {int(observation) // columns}, column {int(observation) % columns}"
    if isinstance(observation, Mapping) or (isinstance(observation, tuple) and any(map(_has_parts, observation))):
        return _number(observation)
    if known.layout == "taxi" and np.ndim(observation) == 0:
        return _taxi(int(observation))
    numbers: Sequence[Any] = np.atleast_1d(np.asarray(observation)).tolist()
    named = known.observation
    if len(named) != len(numbers):
        return _number(observation)
    words = [one.values[number] if one.values else _number(number) for one, number in zip(named, numbers, strict=True)]
    return ", ".join(f"{one.name} {word}" for one, word in zip(named, words, strict=True))


def map_columns(env: gym.Env) -> int | None:
    """Returns the number of columns of a map whose cells are numbered row by row; None if there is no such map."""
    unwrapped: Any = env.unwrapped
    rows, columns = getattr(unwrapped, "nrow", None), getattr(unwrapped, "ncol", None)
    shape = (rows, columns) if columns is not None else getattr(unwrapped, "shape", None)
    space = env.observation_space
    if not isinstance(space, gym.spaces.Discrete) or not isinstance(shape, tuple) or len(shape) != 2:
        return None
    return int(shape[1]) if space.start == 0 and space.n == np.prod(shape) else None


def _taxi(state: int) -> str:
    """Describes a state of Taxi, encoded as ((row * 5 + column) * 5 + passenger) * 4 + destination."""
    place, passenger, destination = state // 20, state // 4 % 5, state % 4
    where = f"at {_PLACES[passenger]}" if passenger < len(_PLACES) else "in the taxi"
    return f"taxi in row {place // 5}, column {place % 5}, passenger {where}, destination {_PLACES[destination]}"


def _has_parts(value: Any) -> bool:
    return isinstance(value, Mapping | tuple) or np.ndim(value) > 0


def _number(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key}: {_number(part)}' for key, part in value.items())}}}"
    if isinstance(value, tuple):
        return f"({', '.join(map(_number, value))})"
    array = np.asarray(value)
    if array.ndim == 0:
        return f"{array.item():.6g}" if array.dtype.kind == "f" else str(array.item())
    return f"({', '.join(_number(part) for part in array)})"
