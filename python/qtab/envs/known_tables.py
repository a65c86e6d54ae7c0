"""Environments of Gymnasium whose transition tables Rust makes: Gymnasium's constructors take milliseconds for them."""

import inspect
from collections.abc import Mapping
from importlib import import_module
from types import ModuleType
from typing import Any

import gymnasium as gym
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec

from qtab import _core
from qtab.envs.registry import ENTRIES, gymnasium_id

VERSION = "1.4."
"""The version of Gymnasium whose tables these are. Any other makes them itself."""

_DIRECTIONS = {0: [-1, 0], 1: [0, 1], 2: [1, 0], 3: [0, -1]}
"""Where the actions of CliffWalking lead to."""
_CLIFF_WALKING: Mapping[str, Any] = {"is_slippery": False}
_TAXI: Mapping[str, Any] = {
    "is_rainy": False,
    "fickle_passenger": False,
    "rainy_probability": 0.8,
    "fickle_probability": 0.3,
}
_DEFAULTS = {"CliffWalking-v1": _CLIFF_WALKING, "CliffWalkingSlippery-v1": _CLIFF_WALKING, "Taxi-v4": _TAXI}
"""The keyword arguments of the constructors, with their defaults, by the environment's id."""


class KnownTable(gym.Env[int, int]):
    """What training needs of an environment of Gymnasium's that Rust steps: the spaces and the transition table.

    Python cannot step it; for that, ``gymnasium.make`` makes the environment.

    Args:
        table: The transition table.
        attributes: What Rust reads besides.
    """

    def __init__(self, table: _core.TransitionTable, **attributes: Any) -> None:
        self.P = table
        self.observation_space = spaces.Discrete(table.states)  # type: ignore[assignment]
        self.action_space = spaces.Discrete(table.actions)  # type: ignore[assignment]
        vars(self).update(attributes)


def known_table(spec: EnvSpec, kwargs: Mapping[str, Any]) -> KnownTable | None:
    """Returns the table of ``gymnasium.make(spec, **kwargs)``; None where only Gymnasium knows it.

    Args:
        spec: The spec of an environment that Rust steps.
        kwargs: Keyword arguments of the constructor.
    """
    name = gymnasium_id(spec.id)
    defaults = _DEFAULTS.get(name)
    if defaults is None or not gym.__version__.startswith(VERSION):
        return None
    arguments = {**defaults, **spec.kwargs, **kwargs}
    if arguments.keys() != defaults.keys() or any(type(arguments[key]) is not type(defaults[key]) for key in defaults):
        return None
    module_name, _, class_name = ENTRIES[name].gymnasium_entry_point.partition(":")
    module: Any = import_module(module_name)
    if not _is_gymnasiums_own(getattr(module, class_name), module):
        return None
    if name != "Taxi-v4":
        own = module.POSITION_MAPPING == _DIRECTIONS
        return KnownTable(_core.TransitionTable.cliff_walking(arguments["is_slippery"])) if own else None
    rainy = arguments["rainy_probability"] if arguments["is_rainy"] else None
    try:
        table = _core.TransitionTable.taxi([line.encode("ascii") for line in module.MAP], rainy)
    except ValueError:  # a map of another size, or what is no probability
        return None
    fickle = {name: arguments[name] for name in ("fickle_passenger", "fickle_probability")}
    return KnownTable(table, **fickle)


def _is_gymnasiums_own(cls: type, module: ModuleType) -> bool:
    """Whether neither the class nor one of its methods was replaced, as a test or a lesson may do.

    A function's globals show where its code is; its name and its module can be those of what it replaces.
    """
    if cls.__module__ != module.__name__:
        return False
    members = [member for member in vars(cls).values() if callable(member) or hasattr(member, "__get__")]
    return all(
        inspect.isgetsetdescriptor(member) or (inspect.isfunction(member) and member.__globals__ is vars(module))
        for member in members
    )
