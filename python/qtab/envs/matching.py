"""Which environment objects Rust may stand in for: those that are still what their id says."""

import gymnasium as gym
from gymnasium.wrappers import OrderEnforcing, PassiveEnvChecker, TimeLimit

from qtab.envs.registry import TABULAR, EnvEntry, entry_for_id

# What gymnasium.make puts around an environment; none of it changes a number.
_HARMLESS = (OrderEnforcing, PassiveEnvChecker, TimeLimit)


def unknown_wrapper(env: gym.Env) -> str | None:
    """Returns the name of the outermost wrapper that may change a number; None where there is none."""
    while isinstance(env, gym.Wrapper):
        if type(env) not in _HARMLESS:
            return type(env).__name__
        env = env.env
    return None


def entry_for_env(env: gym.Env) -> EnvEntry:
    """Returns the model that computes what an environment object would.

    Raises:
        ValueError: if there is none; it names the wrapper or the attribute in the way.
    """
    refused = "backend must be 'gymnasium' or 'auto' for this environment, got 'rust': "
    inner = env.unwrapped
    wrapper = unknown_wrapper(env)
    if wrapper is not None:
        raise ValueError(f"{refused}Rust does not know its wrapper {wrapper}")
    entry_point = f"{type(inner).__module__}:{type(inner).__qualname__}"
    if entry_point == TABULAR.qtab:
        return TABULAR
    spec = inner.spec
    model = entry_for_id(spec.id) if spec is not None else None
    if model is None or entry_point not in (model.gymnasium, model.qtab):
        raise ValueError(f"{refused}Rust has no {type(inner).__qualname__}")
    if model.has_table:
        return model  # whose table is taken as it stands
    from qtab._core import parameter_names

    untouched = type(inner)(**(spec.kwargs if spec is not None else {}))
    for name in parameter_names(model.name):
        now, then = getattr(inner, name), getattr(untouched, name)
        if type(now) not in (int, float, bool, str, list) or now != then:
            raise ValueError(f"{refused}its attribute {name} was changed from {then!r} to {now!r}")
    return model


def is_tabular_env(env: gym.Env) -> bool:
    """Whether this is a :class:`qtab.TabularEnv`, with no more around it than ``gymnasium.make`` puts there."""
    try:
        return entry_for_env(env) is TABULAR
    except ValueError:
        return False


def time_limit(env: gym.Env) -> int | None:
    """Returns the most steps of an episode, as the environment's own wrapper has it."""
    while isinstance(env, gym.Wrapper):
        if isinstance(env, gym.wrappers.TimeLimit):
            return env._max_episode_steps
        env = env.env
    return None


__all__ = ["entry_for_env", "is_tabular_env", "time_limit", "unknown_wrapper"]
