"""Observations and actions in words, for the environments whose meaning is known."""

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.envs.registry import entry_for_id, gymnasium_id

_PUSH = ("push left", "no push", "push right")
_COMPASS = ("up", "right", "down", "left")
COMPONENTS: Mapping[str, tuple[str, ...]] = {
    "MountainCar": ("position", "velocity"),
    "ContinuousMountainCar": ("position", "velocity"),
    "CartPole": ("cart position", "cart velocity", "pole angle", "pole velocity"),
    "Acrobot": ("cos 1", "sin 1", "cos 2", "sin 2", "velocity 1", "velocity 2"),
    "Pendulum": ("cos", "sin", "angular velocity"),
    "Blackjack": ("player's sum", "dealer's card", "usable ace"),
}
"""The components of the observations, by the name of the environment in the extension module."""
ACTIONS: Mapping[str, tuple[str, ...]] = {
    "MountainCar": _PUSH,
    "CartPole": ("push left", "push right"),
    "Acrobot": ("torque -1", "no torque", "torque +1"),
    "Blackjack": ("stick", "hit"),
    "FrozenLake-v1": ("left", "down", "right", "up"),
    "FrozenLake8x8-v1": ("left", "down", "right", "up"),
    "CliffWalking-v1": _COMPASS,
    "CliffWalkingSlippery-v1": _COMPASS,
    "Taxi": ("south", "north", "east", "west", "pick up", "drop off"),
}
"""The names of the actions, by the name of the environment or its id."""
_PLACES = ("red", "green", "yellow", "blue")


def action_name(env: str, column: int, action: Any) -> str:
    """Returns the name of an action, or the action itself."""
    names = _known(ACTIONS, env)
    return names[column] if column < len(names) else _number(action)


def state_in_words(env: str, observation: Any, columns: int | None = None) -> str:
    """Returns an observation in words: its components by name, or a place on a map of so many columns."""
    if columns is not None:
        return f"row {int(observation) // columns}, column {int(observation) % columns}"
    if gymnasium_id(env) == "Taxi-v4":
        return _taxi(int(observation))
    numbers: Sequence[Any] = np.atleast_1d(np.asarray(observation)).tolist()
    names = _known(COMPONENTS, env)
    if len(names) != len(numbers):
        return _number(observation)
    return ", ".join(f"{name} {_number(number)}" for name, number in zip(names, numbers, strict=True))


def map_columns(env: gym.Env) -> int | None:
    """Returns the columns of a map whose places are numbered row by row; None where there is no such map."""
    unwrapped: Any = env.unwrapped
    rows, columns = getattr(unwrapped, "nrow", None), getattr(unwrapped, "ncol", None)
    shape = (rows, columns) if columns is not None else getattr(unwrapped, "shape", None)
    space = env.observation_space
    if not isinstance(space, gym.spaces.Discrete) or not isinstance(shape, tuple) or len(shape) != 2:
        return None
    return int(shape[1]) if space.start == 0 and space.n == np.prod(shape) else None


def _taxi(state: int) -> str:
    """Taxi's encoding: ((row * 5 + column) * 5 + passenger) * 4 + destination."""
    place, passenger, destination = state // 20, state // 4 % 5, state % 4
    where = f"at {_PLACES[passenger]}" if passenger < len(_PLACES) else "in the taxi"
    return f"taxi in row {place // 5}, column {place % 5}, passenger {where}, destination {_PLACES[destination]}"


def _known(words: Mapping[str, tuple[str, ...]], env: str) -> tuple[str, ...]:
    entry = entry_for_id(env)
    return () if entry is None else words.get(entry.name, words.get(gymnasium_id(env), ()))


def _number(value: Any) -> str:
    array = np.asarray(value)
    if array.ndim == 0:
        return f"{array.item():.6g}" if array.dtype.kind == "f" else str(array.item())
    return f"({', '.join(_number(part) for part in array)})"
