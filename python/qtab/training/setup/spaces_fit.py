"""Fits a config to the spaces of its environment, such as a preset whose settings wrappers made meaningless."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from qtab.config import DEFAULTS, Config
from qtab.config.config import replace_checked
from qtab.config.options import OPTIONS, WITH_STATE_VALUES, is_set, n_tables
from qtab.config.validation import mismatch, uses_tiles, uses_weighted
from qtab.discretizers import Discretizer, is_plain
from qtab.discretizers.identity import integer_bounds

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
    if env.observation_space is not inner.observation_space and not _same_units(
        env.observation_space, inner.observation_space
    ):
        names += _OF_COMPONENTS
        if config.tiles is not None and len(config.tiles) > 1:
            names.append("tiles")
        with suppress(ValueError):  # an unsupported space is reported later
            if _is_discrete(env.observation_space, config):
                names += _OF_DISCRETIZERS
    if names and isinstance(config.initial_q, np.ndarray):
        names.append("initial_q")
    if names:
        config = _with_defaults(config, names, asked)
    if config.learning_rate > 1 and not (uses_tiles(config.discretizer) or uses_weighted(config.discretizer)):
        config = _with_defaults(config, ["learning_rate"], asked)
    return config


def _same_units(one: Any, other: Any) -> bool:
    """Returns whether two spaces are equal except for the dtypes and shapes of Boxes."""
    if one == other:
        return True
    if not isinstance(one, spaces.Box) or not isinstance(other, spaces.Box) or one.low.size != other.low.size:
        return False
    return np.allclose(one.low.ravel(), other.low.ravel()) and np.allclose(one.high.ravel(), other.high.ravel())


def _with_defaults(config: Config, names: list[str], asked: Mapping[str, Any]) -> Config:
    return replace_checked(config, **{name: DEFAULTS[name] for name in names if not is_set(asked.get(name))})


def _is_discrete(space: Any, config: Config) -> bool:
    """Returns whether all components of a space are discrete.

    Raises:
        ValueError: if the space is not supported.
    """
    if integer_bounds(space) is not None:
        return True
    if is_plain(space):
        return False
    from qtab.discretizers.groups import is_discrete
    from qtab.discretizers.layout import Layout

    return is_discrete(Layout.of_space(space), config)


def infer_discretizer(space: Any, config: Config, asked: Mapping[str, Any]) -> Config:
    """Returns a config whose discretizer is ``"identity"`` if observations are discrete and no discretizer was given.

    Raises:
        ValueError: if a scale was given, which then has no meaning, or if the space is not supported.
    """
    if config.discretizer != "round":
        return config
    is_given = "scale" in asked or "discretizer" in asked
    if integer_bounds(space) is None and (is_given or not _is_discrete(space, config)):
        return config
    identity = replace_checked(config, discretizer="identity")
    if "scale" in asked and config.scale and (reason := mismatch("scale", config.scale, vars(identity))):
        raise ValueError(reason)
    return replace_checked(identity, scale=())


def fit_initial_q(config: Config, discretizer: Discretizer, n_actions: int) -> Any:
    """Returns the initial Q table. For an algorithm with two tables, a single one is used twice, or with zeros."""
    initial_q, count = config.initial_q, n_tables(config.algorithm)
    if not isinstance(initial_q, np.ndarray):
        return initial_q
    if config.max_rows is not None:
        raise ValueError(
            "initial_q must be a number or a range with max_rows, which assigns the rows anew, got a table"
        )
    one = (*discretizer.shape, n_actions)
    shape = one if count == 1 else (count, *one)
    if initial_q.shape == one and count > 1:
        second = np.zeros(one) if config.algorithm in WITH_STATE_VALUES else initial_q
        both = np.stack([initial_q, second])
        both.flags.writeable = False
        return both
    if initial_q.shape not in (shape, (count, discretizer.n_rows, n_actions)):
        raise ValueError(f"initial_q must have the table's shape {shape}, got {initial_q.shape}")
    if config.algorithm in WITH_STATE_VALUES:
        values = initial_q.reshape(count, -1, n_actions)[1]
        if not np.isfinite(values).all() or (values != values[:, :1]).any():
            raise ValueError("initial_q must have in its second table the value of a state in each of its columns")
        return initial_q
    missing = np.isneginf(initial_q.reshape(count, -1))
    if (missing != missing[0]).any():
        raise ValueError("initial_q must have -inf in both tables or in none, got it in one")
    return initial_q
