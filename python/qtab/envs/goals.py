"""The meaning of returns in an environment: the threshold at which it is solved, and the best known return."""

import inspect
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec, load_env_creator

from qtab.config import Config
from qtab.config.origin import trained_on
from qtab.envs.origin.description import EnvironmentDescription
from qtab.envs.origin.registered import what_changes_returns
from qtab.envs.registry import entry_for_id, gymnasium_id
from qtab.envs.stored import is_registered

BEST_KNOWN_MOUNTAIN_CAR = -97.668
"""The expected return that ``qtab.optimum("MountainCar-v0")`` finds in seconds."""
MAX_QUICK_UPDATES = 10**8
"""The optimum of a table is computed if it needs at most this many updates, which take less than a second."""
UNLIMITED_MAX_EPISODE_STEPS = 10_000
"""The time limit in training for environments that have none."""


def reward_threshold(
    env: str,
    env_kwargs: Mapping[str, Any],
    max_episode_steps: int | None,
    description: EnvironmentDescription | None = None,
) -> float | None:
    """Returns the return at which Gymnasium considers an environment solved; None if it gives none.

    The threshold applies to the environment as it is registered: with another time limit, other keyword arguments,
    wrappers or attributes the same return has another meaning.

    Args:
        env: The id.
        env_kwargs: The keyword arguments of its constructor.
        max_episode_steps: The time limit, in steps.
        description: The environment in detail; None if it is not known.
    """
    spec = _registered(env)
    if spec is None or spec.reward_threshold is None:
        return None
    return None if _why_not_as_registered(spec, env_kwargs, max_episode_steps, description) else spec.reward_threshold


def threshold_of(config: Config) -> float | None:
    """Returns the threshold that applies to the config of a run; see :func:`reward_threshold`."""
    return reward_threshold(config.env, config.env_kwargs, config.max_episode_steps, trained_on(config))


def registered_threshold(env: str) -> float | None:
    """Returns the threshold of an environment as it is registered; None if it has none."""
    spec = _registered(env)
    return None if spec is None else spec.reward_threshold


def why_no_threshold(config: Config) -> str:
    """Returns the reason why no threshold applies to the config of a run."""
    spec = _registered(config.env)
    if spec is None or spec.reward_threshold is None:
        return "Gymnasium defines no threshold"
    reason = _why_not_as_registered(spec, config.env_kwargs, config.max_episode_steps, trained_on(config))
    return f"Gymnasium's threshold of {spec.reward_threshold:g} {reason}"


def is_usual_mountain_car(config: Config) -> bool:
    """Returns whether a run is on MountainCar-v0 with the default constants and time limit."""
    spec = _registered(config.env)
    if spec is None or gymnasium_id(config.env) != "MountainCar-v0":
        return False
    return _why_not_as_registered(spec, config.env_kwargs, config.max_episode_steps, trained_on(config)) is None


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
    steps = 1 if config.time_aware else config.max_episode_steps or 0  # a time-aware table has rows for each step
    return n_rows * n_actions * steps <= MAX_QUICK_UPDATES


def own_time_limit(env: str) -> int | None:
    """Returns the time limit with which an environment is registered; None if it has none."""
    spec = _registered(env)
    return None if spec is None else spec.max_episode_steps


def _registered(env: str) -> EnvSpec | None:
    """Returns the spec of a complete id. Nothing is imported: the id may come from a file."""
    return gym.registry.get(env.rpartition(":")[2])


def _why_not_as_registered(
    spec: EnvSpec,
    env_kwargs: Mapping[str, Any],
    max_episode_steps: int | None,
    description: EnvironmentDescription | None,
) -> str | None:
    """Returns the reason why the threshold of a spec does not apply, to follow its number; None if it does."""
    limit = spec.max_episode_steps or UNLIMITED_MAX_EPISODE_STEPS
    if max_episode_steps != limit:
        return f"holds for {limit:,} steps, not for max_episode_steps={max_episode_steps}"
    if not _has_usual_arguments(spec, env_kwargs):
        return "does not hold for other env_kwargs"
    change = None if description is None else what_changes_returns(description, spec, env_kwargs)
    return None if change is None else f"does not hold for the returns of this environment: {change}"


def _has_usual_arguments(spec: EnvSpec, env_kwargs: Mapping[str, Any]) -> bool:
    own = {**spec.kwargs, "render_mode": None}
    others = {name: value for name, value in env_kwargs.items() if name not in own}
    if others:
        own |= _constructor_defaults(spec)
    return all(
        name == "render_mode" or (name in own and _equal(value, own[name])) for name, value in env_kwargs.items()
    )


def _constructor_defaults(spec: EnvSpec) -> dict[str, Any]:
    """Returns the defaults of the constructor's arguments, for environments whose class is known."""
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
