"""The settings that a call requests, merged in layers into one checked config.

The preset is the lowest layer, then come the config that the call starts from and files, then keywords.
"""

import inspect
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import cache
from typing import Any, TypeAlias

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec

from qtab._utils.shown import shown
from qtab.config.config import DEFAULTS, Config, replace_checked
from qtab.config.implied import (
    algorithm_defaults,
    implied_schedules,
    rescaled_settings,
    weighted_defaults,
    without_rates,
)
from qtab.config.options import OFF_BY_NONE, OPTIONS, freed_settings, is_set
from qtab.config.origin import copied
from qtab.config.presets import preset
from qtab.config.unknown import check_names
from qtab.config.validation import defaults, mismatch
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
    to the other settings, or that are derived again are left out, as are rates and initial weights that mean something
    else with the requested discretizer. An option that is off in the config of a run stays off, even if a preset sets
    it.
    """
    if isinstance(base, Config):
        left_out = {"env", *freed_settings(base.algorithm, settings.get("algorithm", base.algorithm))}
        left_out |= rescaled_settings(vars(base), settings)
        if base.origin is not None:
            left_out |= base.origin.derived_again
        if base.time_aware and not settings.get("time_aware", True):
            left_out.add("on_truncation")
        given = {name: value for name, value in vars(base).items() if name not in left_out and is_set(value)}
        base = _applicable({**given, **_turned_off(vars(base))}, {**vars(base), **settings})
    return {**base, **settings}


def config_of(env: str, asked: Mapping[str, Any]) -> Config:
    """Returns the config of an environment: the requested settings over those of its preset.

    A preset is a starting point: its settings that do not apply to the requested ones are left out, and a requested
    algorithm brings its own defaults, as does a discretizer with weighted features.

    Raises:
        TypeError: for an unknown setting, or one of the wrong type.
        ValueError: for a setting out of range, or an unknown preset.
    """
    name = asked.get("preset")
    if name is not None and not isinstance(name, str):
        raise TypeError(f"preset must be a name, got {shown(name)}")
    name, start = preset(env, name)
    weighted = weighted_defaults(asked)
    own = {**weighted, **algorithm_defaults(start, asked)}
    start = without_rates(start, {**weighted, **asked})
    own = {**implied_schedules({**weighted, **asked}, {**DEFAULTS, **start, **own, **asked}), **own}
    start = _applicable(start, {**DEFAULTS, **start, **own, **asked})
    own = _applicable(own, {**DEFAULTS, **start, **own, **asked})
    try:
        return Config(**{**start, **own, **asked, "env": env, "preset": name})
    except ValueError as error:
        raise naming_preset(error, name, start.keys() - own.keys(), asked) from None


def naming_preset(
    error: ValueError, name: str | None, settings: Collection[str], asked: Mapping[str, Any]
) -> ValueError:
    """Returns an error about a setting; about one of a preset, with the addition that it comes from the preset.

    Args:
        error: The error, whose message begins with the name of the setting.
        name: The name of the preset.
        settings: The settings used from the preset.
        asked: The requested settings.
    """
    setting = str(error).split(" ", 1)[0]
    if name is None or setting not in settings or is_set(asked.get(setting)):
        return error
    return ValueError(f"{error}; this is the {setting} of preset {name!r}; give another one")


def merge(env: str, *layers: Mapping[str, Any]) -> Config:
    """Returns the config of an environment: its preset, then each layer over the previous one.

    Raises:
        TypeError: for an unknown setting, or one of the wrong type.
        ValueError: for a setting out of range, or an unknown preset.
    """
    asked: dict[str, Any] = {}
    for layer in layers:
        asked.update(layer)
    return config_of(env, asked)


def _turned_off(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the options that are off in a complete config, such as that of a run, each as None.

    A config with unset options is not complete, so any of its options may be unset.
    """
    if defaults(fields):
        return {}
    return {name: None for name in OFF_BY_NONE if fields[name] is None and not mismatch(name, None, fields)}


def _applicable(fields: Mapping[str, Any], others: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings in ``fields`` that are compatible with the others, without options that do not apply."""
    kept = {name: value for name, value in fields.items() if not mismatch(name, value, others)}
    for name, option in OPTIONS.items():
        if option.choice in fields and option.choice not in kept:
            kept.pop(name, None)
    return kept
