"""Training from the config of a run: in the environment of that run, or in another one."""

from collections.abc import Callable, Mapping
from typing import Any

import gymnasium as gym

from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.config.layers import Base, collect, over
from qtab.config.origin import trained_on
from qtab.envs.origin.describe import describe
from qtab.envs.origin.differences import differences
from qtab.training.resolved_run import ResolvedRun
from qtab.training.run_env import Attempt, as_in_training, with_origin_of


def collect_for(
    env: Any, function: Callable[..., Any], config: Base | None, settings: Mapping[str, Any]
) -> tuple[Any, Base]:
    """Calls :func:`qtab.config.layers.collect`, but keeps derived settings if an object is the config's environment."""
    given, base = collect(function, env, config, settings)
    if isinstance(env, gym.Env) and isinstance(config, Config):
        description = trained_on(config)
        if description is not None and not differences(description, describe(env)):
            return env, replace_checked(config, env_kwargs={})
    return given, base


def resolve_over(
    env: Any, base: Base, settings: Mapping[str, Any], attempt: Attempt
) -> tuple[ResolvedRun, Any, dict[str, Any]]:
    """Resolves the settings of a call over the config that it starts from.

    Args:
        env: The environment of the call.
        base: The config or the settings that it starts from.
        settings: The settings given.
        attempt: Resolves settings in an environment.

    Returns:
        The resolved run, its environment as ``attempt`` took it, and the settings for that.

    Raises:
        ValueError: if the environment of the config cannot be made as it was, or a setting does not fit.
    """
    asked = over(base, settings)
    if not isinstance(base, Config):
        return attempt(env, asked), env, asked
    if env != base.env:
        return with_origin_of(attempt(env, asked), base, settings), env, asked
    resolved, made, asked = as_in_training(base, asked, attempt)
    return with_origin_of(resolved, base, settings), made, asked
