"""Adapts a config to the spaces of its environment: drops preset settings that wrappers made meaningless."""

from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from qtab.config import DEFAULTS, Config
from qtab.config.config import replace_checked
from qtab.config.functions import uses_tiles
from qtab.config.options import OPTIONS, is_set
from qtab.config.validation import mismatch
from qtab.discretizers import is_plain
from qtab.discretizers.groups import is_discrete
from qtab.discretizers.identity import integer_bounds
from qtab.discretizers.layout import Layout

_OF_COMPONENTS = ("scale", "bins", "edges", "low", "high")
"""The settings that hold a number for each component of the observation, in its units."""
_OF_DISCRETIZERS = ("discretizer", *(name for name, option in OPTIONS.items() if option.choice == "discretizer"))


def set_aside(env: gym.Env, config: Config, asked: Mapping[str, Any]) -> Config:
    """Returns a config without the preset settings that have no meaning in the spaces of the wrapped environment.

    Args:
        env: The environment, with its wrappers.
        config: The preset, overridden by the settings given.
        asked: The settings given.
    """
    if config.preset is None:
        return config
    inner, names = env.unwrapped, []
    if env.action_space is not inner.action_space and env.action_space != inner.action_space:
        names.append("actions")
    if not _same_units(env.observation_space, inner.observation_space):
        names += _OF_COMPONENTS
        if config.tiles is not None and len(config.tiles) > 1:
            names.append("tiles")
        if _is_discrete(env.observation_space, config):
            names += _OF_DISCRETIZERS
    if names and isinstance(config.initial_q, np.ndarray):
        names.append("initial_q")
    config = _with_defaults(config, names, asked)
    if config.learning_rate > 1 and not uses_tiles(config.discretizer):
        config = _with_defaults(config, ["learning_rate"], asked)
    return config


def _same_units(one: Any, other: Any) -> bool:
    """Returns whether two spaces are equal except for the dtypes and shapes of Boxes."""
    if one is other or one == other:
        return True
    if not isinstance(one, spaces.Box) or not isinstance(other, spaces.Box) or one.low.size != other.low.size:
        return False
    return np.allclose(one.low.ravel(), other.low.ravel()) and np.allclose(one.high.ravel(), other.high.ravel())


def _with_defaults(config: Config, names: list[str], asked: Mapping[str, Any]) -> Config:
    return replace_checked(config, **{name: DEFAULTS[name] for name in names if not is_set(asked.get(name))})


def _is_discrete(space: Any, config: Config) -> bool:
    try:
        return integer_bounds(space) is not None or is_discrete(Layout.of_space(space), config)
    except ValueError:  # unsupported space: reported elsewhere
        return False


def infer_discretizer(space: Any, config: Config, asked: Mapping[str, Any]) -> Config:
    """Returns a config whose discretizer is ``"identity"`` if observations are discrete and no discretizer was given.

    Raises:
        ValueError: if a scale was given, which then has no meaning, or if the space is not supported.
    """
    if config.discretizer != "round":
        return config
    if integer_bounds(space) is None:
        if is_plain(space) or "scale" in asked or "discretizer" in asked:
            return config
        if not is_discrete(Layout.of_space(space), config):
            return config
    identity = replace_checked(config, discretizer="identity")
    if "scale" in asked and config.scale and (reason := mismatch("scale", config.scale, vars(identity))):
        raise ValueError(reason)
    return replace_checked(identity, scale=())
