"""Gymnasium's environments as the extension module steps them: by their parameters, their table or their rules.

Rust also makes the transition tables for which Gymnasium's constructors take milliseconds.
"""

from collections.abc import Mapping
from functools import lru_cache
from importlib import import_module
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec
from gymnasium.envs.toy_text.blackjack import BlackjackEnv

from qtab import _core
from qtab.envs.actions import Actions
from qtab.envs.in_rust.matching import NotInRustError
from qtab.envs.origin.class_code import changed_entry_point
from qtab.envs.registry import ENTRIES, TABULAR, gymnasium_id

VERSION = "1.4."
"""The version of Gymnasium that has these tables. With any other version, Gymnasium makes them."""

_DIRECTIONS = {0: [-1, 0], 1: [0, 1], 2: [1, 0], 3: [0, -1]}
"""The move of each action of CliffWalking: rows and columns."""
_LEFT_DOWN_RIGHT_UP = (0, 1, 2, 3)
"""The actions of FrozenLake."""
_LETTERS = frozenset("SFHG")
"""The letters of a frozen lake: start, frozen, hole, goal."""


class KnownTable(gym.Env[int, int]):
    """The spaces and the transition table of a Gymnasium environment, which suffice for training in Rust.

    Python cannot step it; for that, ``gymnasium.make`` makes the environment.

    Args:
        table: The transition table.
        attributes: Other attributes that Rust reads.
    """

    def __init__(self, table: _core.TransitionTable, **attributes: Any) -> None:
        self.P = table
        self.observation_space = spaces.Discrete(table.states)  # type: ignore[assignment]
        self.action_space = spaces.Discrete(table.actions)  # type: ignore[assignment]
        vars(self).update(attributes)


def known_table(spec: EnvSpec, kwargs: Mapping[str, Any]) -> KnownTable | None:
    """Returns the table of ``gymnasium.make(spec, **kwargs)``; None if only Gymnasium can make it.

    Args:
        spec: The spec of an environment that Rust steps.
        kwargs: Keyword arguments of the constructor.
    """
    name = gymnasium_id(spec.id)
    make_table = _KNOWN.get(name)
    if make_table is None or not gym.__version__.startswith(VERSION):
        return None
    defaults: dict[str, Any] = make_table.__kwdefaults__
    arguments = {**defaults, **spec.kwargs, **kwargs}
    if arguments.keys() != defaults.keys() or any(type(arguments[key]) is not type(defaults[key]) for key in defaults):
        return None
    entry_point = ENTRIES[name].gymnasium_entry_point
    if changed_entry_point(entry_point) is not None:
        return None
    try:
        module = import_module(entry_point.partition(":")[0])
        known: KnownTable | None = make_table(module, **arguments)
    except (OverflowError, ValueError):  # arguments that Gymnasium refuses, or a map of another size
        return None
    return known


def _cliff_walking(module: Any, *, is_slippery: bool = False) -> KnownTable | None:
    own = module.POSITION_MAPPING == _DIRECTIONS
    return KnownTable(_core.TransitionTable.cliff_walking(is_slippery)) if own else None


def _frozen_lake(
    module: Any,
    *,
    desc: None = None,  # noqa: ARG001 - a map of the user's is left to Gymnasium
    map_name: str = "4x4",
    is_slippery: bool = True,
    success_rate: float = 1.0 / 3.0,
    reward_schedule: tuple[float, ...] = (1, 0, 0),
) -> KnownTable | None:
    lines = module.MAPS.get(map_name)
    if (
        (module.LEFT, module.DOWN, module.RIGHT, module.UP) != _LEFT_DOWN_RIGHT_UP
        or not isinstance(lines, list)
        or not all(isinstance(line, str) and len(line) > 1 and _LETTERS.issuperset(line) for line in lines)
        or len(reward_schedule) != 3
        or not all(type(reward) in (int, float) for reward in reward_schedule)
    ):
        return None
    rate = success_rate if is_slippery else None
    return KnownTable(_core.TransitionTable.frozen_lake([line.encode() for line in lines], rate, reward_schedule))


def _taxi(
    module: Any,
    *,
    is_rainy: bool = False,
    fickle_passenger: bool = False,
    rainy_probability: float = 0.8,
    fickle_probability: float = 0.3,
) -> KnownTable:
    rain = rainy_probability if is_rainy else None
    table = _taxi_table(tuple(line.encode("ascii") for line in module.MAP), rain)
    return KnownTable(table, fickle_passenger=fickle_passenger, fickle_probability=fickle_probability)


@lru_cache(maxsize=4)
def _taxi_table(lines: tuple[bytes, ...], rain: float | None) -> _core.TransitionTable:
    # Cached: making it takes as long as everything else before the first step, and nothing can change it.
    return _core.TransitionTable.taxi(lines, rain)


_KNOWN: Mapping[str, Any] = {
    "CliffWalking-v1": _cliff_walking,
    "CliffWalkingSlippery-v1": _cliff_walking,
    "FrozenLake-v1": _frozen_lake,
    "FrozenLake8x8-v1": _frozen_lake,
    "Taxi-v4": _taxi,
}
"""The functions that make the tables, by the id. Their keyword arguments and defaults are those of the constructors."""


def native_env(name: str, env: Any, actions: Actions | None = None) -> _core.NativeEnv:
    """Returns an environment that Rust steps, with the current attributes of the unwrapped Gymnasium environment.

    Args:
        name: The name of its registry entry.
        env: The environment.
        actions: The actions that a learner chooses from.

    Raises:
        TypeError: if a table holds types for which Rust would not compute the sums that NumPy does.
        ValueError: if Rust would not compute the same numbers as NumPy, for an attribute, the action space or on this
            machine.
    """
    if not _core.matches_numpy(name):
        raise ValueError("NumPy's sin and cos are not the platform's on this machine, which Rust calls")
    if actions is None or actions.values is None:
        return _core.NativeEnv(name, env)
    if actions.values.dtype != np.float32:
        raise ValueError(f"Rust computes with actions of float32, got {actions.values.dtype}")
    return _core.NativeEnv(name, env, actions.values[:, 0].tolist())


def table_env(env: Any) -> _core.NativeEnv:
    """Returns an environment that Rust steps by the transition table of Gymnasium's toy text, or of any other.

    Raises:
        TypeError: if the table holds types for which Rust would not compute the sums that NumPy does.
        ValueError: if ``P`` and ``initial_state_distrib`` are not a valid table.
    """
    if isinstance(env, BlackjackEnv):
        return native_env("Blackjack", env)
    return native_env("Taxi" if hasattr(env, "fickle_passenger") else TABULAR.name, env)


def check_not_shown(env: gym.Env) -> None:
    """Raises an error for an environment with a render mode, so that Python steps it and its frames are shown."""
    if getattr(env.unwrapped, "render_mode", None) is not None:
        remedy = "without a render mode Rust steps it; record= and qtab train --watch show the last episodes afterwards"
        raise NotInRustError(f"its render_mode is {env.unwrapped.render_mode!r}", remedy)
