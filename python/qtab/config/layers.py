"""The settings that a call requests: its keywords, over the config that it starts from."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any, TypeAlias

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec

from qtab._utils.shown import shown
from qtab.config.compatibility import applicable, turned_off
from qtab.config.config import DEFAULTS, Config, replace_checked
from qtab.config.options import freed_settings, is_set
from qtab.config.origin import copied
from qtab.config.unknown import check_names
from qtab.envs.registry import versioned

Base: TypeAlias = Config | Mapping[str, Any]
"""The config that a call starts from: a complete one, such as that of a run, or some settings."""


def collect(
    function: Callable[..., Any], env: Any, config: Base | None, settings: Mapping[str, Any]
) -> tuple[Any, Base]:
    """Checks the names of a call's settings; returns its environment and the config that it starts from.

    Args:
        function: The function that was called. Its signature lists its settings.
        env: The environment given; None uses the config's.
        config: The config given. With another environment, its ``env_kwargs``, its ``preset``, and the settings derived
            from its own environment are ignored.
        settings: The keywords given.

    Raises:
        TypeError: for an unknown setting, or a config that is neither a Config nor a mapping.
    """
    arguments = _arguments(function)
    check_names(settings, arguments, function.__name__)
    if config is None:
        return env, {}
    if isinstance(config, Config):
        if "seed" not in arguments:
            config = replace_checked(config, seed=None)
        if isinstance(env, str):
            env = versioned(env)
        registered = gym.registry.get(config.env.rpartition(":")[2]) if isinstance(env, EnvSpec) else None
        if env is None or env in (config.env, registered):
            return config.env, config
        origin = config.origin and replace(config.origin, environment=None)
        return env, copied(replace_checked(config, env_kwargs={}, preset=None), origin)
    if not isinstance(config, Mapping):
        raise TypeError(f"config must be a qtab.Config or a mapping of settings, got {shown(config)}")
    check_names(config, [name for name in DEFAULTS if name in arguments], function.__name__)
    base = dict(config)
    named = base.pop("env", None)
    return named if env is None else env, base


@cache
def _arguments(function: Callable[..., Any]) -> frozenset[str]:
    return frozenset(inspect.signature(function).parameters)


def over(base: Base, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Returns settings over the base of a call.

    The items of a mapping count like keywords. A Config contributes fewer: fields that are not set, that do not apply
    to the other settings, or that are derived again are left out. An option that is off in the config of a run stays
    off, even if a preset sets it.
    """
    if isinstance(base, Config):
        left_out = {"env", *freed_settings(base.algorithm, settings.get("algorithm", base.algorithm))}
        if base.origin is not None:
            left_out |= base.origin.derived_again
        if base.time_aware and not settings.get("time_aware", True):
            left_out.add("on_truncation")
        given = {name: value for name, value in vars(base).items() if name not in left_out and is_set(value)}
        base = applicable({**given, **turned_off(vars(base))}, {**vars(base), **settings})
    return {**base, **settings}
