"""Matching of environment objects to registry entries: Rust replaces only those whose numbers it reproduces."""

from typing import Any

import gymnasium as gym
from gymnasium.wrappers import OrderEnforcing, PassiveEnvChecker, TimeLimit

from qtab.envs.registry import TABULAR, EnvEntry, entry_for_id

# The wrappers of gymnasium.make, none of which changes an observation or a reward.
_HARMLESS_WRAPPERS = (OrderEnforcing, PassiveEnvChecker, TimeLimit)


def unknown_wrapper(env: gym.Env) -> str | None:
    """Returns the class name of the outermost wrapper that may change a number; None if there is none."""
    while isinstance(env, gym.Wrapper):
        if type(env) not in _HARMLESS_WRAPPERS:
            return type(env).__name__
        env = env.env
    return None


def rust_unavailable(reason: str) -> ValueError:
    """Returns the error for ``backend="rust"`` where Rust cannot step the environment."""
    return ValueError(f"backend must be 'auto' or 'gymnasium' for this environment, got 'rust': {reason}")


def entry_for_env(env: gym.Env) -> EnvEntry:
    """Returns the registry entry that computes the same numbers as an environment object.

    Raises:
        ValueError: if there is none; the message names the class, wrapper or attribute that rules it out.
    """
    unwrapped: Any = env.unwrapped
    wrapper = unknown_wrapper(env)
    if wrapper is not None:
        raise rust_unavailable(f"Rust does not implement its wrapper {wrapper}")
    if _entry_point(unwrapped) == TABULAR.entry_point:
        return TABULAR
    spec = unwrapped.spec
    entry = entry_for_id(spec.id) if spec is not None else None
    if entry is None or _entry_point(unwrapped) not in (entry.gymnasium_entry_point, entry.entry_point):
        raise rust_unavailable(f"Rust does not implement {type(unwrapped).__qualname__}")
    if entry.has_table:
        return entry  # Rust reads the table from the object, so no attribute can be out of date
    from qtab._core import parameter_names

    default = type(unwrapped)(**(spec.kwargs if spec is not None else {}))
    for name in parameter_names(entry.name):
        value, default_value = getattr(unwrapped, name), getattr(default, name)
        if type(value) not in (int, float, bool, str, list) or value != default_value:
            raise rust_unavailable(f"its attribute {name} was changed from {default_value!r} to {value!r}")
    return entry


def is_tabular_env(env: gym.Env) -> bool:
    """Returns whether this is a :class:`qtab.TabularEnv` with no wrapper other than those of ``gymnasium.make``."""
    return unknown_wrapper(env) is None and _entry_point(env.unwrapped) == TABULAR.entry_point


def time_limit(env: gym.Env) -> int | None:
    """Returns the time limit in steps that an environment's ``TimeLimit`` wrapper sets; None without one."""
    while isinstance(env, gym.Wrapper):
        if isinstance(env, gym.wrappers.TimeLimit):
            return env._max_episode_steps
        env = env.env
    return None


def _entry_point(env: gym.Env) -> str:
    return f"{type(env).__module__}:{type(env).__qualname__}"


__all__ = ["entry_for_env", "is_tabular_env", "rust_unavailable", "time_limit", "unknown_wrapper"]
