"""What returns mean in an environment: the threshold at which it is solved, and the best return that is known."""

import inspect
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec, load_env_creator

from qtab.config import Config
from qtab.envs.registry import entry_for_id, gymnasium_id
from qtab.envs.stored import is_registered

BEST_KNOWN_MOUNTAIN_CAR = -97.668
"""The expected return that ``qtab.optimum("MountainCar-v0")`` finds in seconds."""
MAX_QUICK_UPDATES = 10**8
"""The optimum of a table is computed if it needs at most this many updates, which take less than a second."""
UNLIMITED_MAX_EPISODE_STEPS = 10_000
"""The time limit in training for environments that have none."""


def reward_threshold(env: str, env_kwargs: Mapping[str, Any], max_episode_steps: int | None) -> float | None:
    """Returns the return at which Gymnasium considers an environment solved; None where it gives none.

    It gives one for the environment as it is registered: with another time limit or other keyword arguments the same
    return means something else.
    """
    spec = _registered(env)
    if spec is None or not _is_as_registered(spec, env_kwargs, max_episode_steps):
        return None
    return spec.reward_threshold


def threshold_of(config: Config) -> float | None:
    """Returns the threshold that holds for a resolved config; see :func:`reward_threshold`."""
    return reward_threshold(config.env, config.env_kwargs, config.max_episode_steps)


def registered_threshold(env: str) -> float | None:
    """Returns the threshold of an environment as it is registered; None where it has none."""
    spec = _registered(env)
    return None if spec is None else spec.reward_threshold


def why_no_threshold(config: Config) -> str:
    """Returns why no threshold holds for a resolved config."""
    spec = _registered(config.env)
    if spec is None or spec.reward_threshold is None:
        return "Gymnasium defines no threshold"
    its = f"Gymnasium's threshold of {spec.reward_threshold:g}"
    limit = spec.max_episode_steps or UNLIMITED_MAX_EPISODE_STEPS
    if config.max_episode_steps != limit:
        return f"{its} holds for {limit:,} steps, not for max_episode_steps={config.max_episode_steps}"
    return f"{its} does not hold for other env_kwargs"


def is_usual_mountain_car(config: Config) -> bool:
    """Returns whether a run is on MountainCar-v0 with its own constants and time limit."""
    spec = _registered(config.env)
    return (
        spec is not None
        and gymnasium_id(config.env) == "MountainCar-v0"
        and _is_as_registered(spec, config.env_kwargs, config.max_episode_steps)
    )


def has_quick_optimum(config: Config, n_rows: int, n_actions: int) -> bool:
    """Returns whether the optimum of a resolved config's environment is computed in less than a second.

    Args:
        config: The config.
        n_rows: The number of rows of the run's table.
        n_actions: The number of actions.
    """
    entry = entry_for_id(config.env)
    if config.backend != "rust" or entry is None or not entry.knows_transitions or not is_registered(config.env):
        return False
    steps = 1 if config.time_aware else config.max_episode_steps or 0  # a table that counts them has rows for each
    return n_rows * n_actions * steps <= MAX_QUICK_UPDATES


def own_time_limit(env: str) -> int | None:
    """Returns the time limit with which an environment is registered; None where it has none."""
    spec = _registered(env)
    return None if spec is None else spec.max_episode_steps


def _registered(env: str) -> EnvSpec | None:
    """The spec of a complete id. Nothing is imported: the id may come from a file."""
    return gym.registry.get(env.rpartition(":")[2])


def _is_as_registered(spec: EnvSpec, env_kwargs: Mapping[str, Any], max_episode_steps: int | None) -> bool:
    if max_episode_steps != (spec.max_episode_steps or UNLIMITED_MAX_EPISODE_STEPS):
        return False
    own = {**spec.kwargs, "render_mode": None}
    others = {name: value for name, value in env_kwargs.items() if name not in own}
    if others:
        own |= _constructor_defaults(spec)
    return all(
        name == "render_mode" or (name in own and _equal(value, own[name])) for name, value in env_kwargs.items()
    )


def _constructor_defaults(spec: EnvSpec) -> dict[str, Any]:
    """The defaults of the constructor's arguments, of environments whose class is known."""
    entry = entry_for_id(spec.id)
    if entry is None:
        return {}
    parameters = inspect.signature(load_env_creator(entry.gymnasium_entry_point or entry.entry_point)).parameters
    return {name: value.default for name, value in parameters.items() if name not in spec.kwargs}


def _equal(one: Any, other: Any) -> bool:
    try:
        return bool(one == other)
    except ValueError:  # arrays
        return False
