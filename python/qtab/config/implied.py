"""Settings that follow from others: with an algorithm, with a rate, and with a change to a config."""

from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.config.options import FIXED, OPTIONS, PREFERENCES, fixed_settings, freed_settings, is_set
from qtab.config.origin import Origin
from qtab.config.unknown import check_names
from qtab.config.validation import mismatch, uses_weighted

_AVERAGES: Mapping[str, Any] = {"learning_rate": 1.0, "learning_rate_schedule": "visits"}
"""Averages of returns as values."""

_OF_ALGORITHM: Mapping[str, Mapping[str, Any]] = {
    "monte_carlo": _AVERAGES,
    "monte_carlo_es": {**_AVERAGES, "epsilon": 0.0},  # exploring starts are the only exploration
    "off_policy_monte_carlo": _AVERAGES,
    **{algorithm: fixed.values for algorithm, fixed in FIXED.items()},
}
"""The settings of each algorithm that differ from those of :class:`qtab.Config`."""
_OF_WEIGHTED: Mapping[str, Any] = {"learning_rate": 0.001, "initial_q": 0.0}
"""The same for weighted features: a learning rate is not divided among them, and initial weights are no values."""
_OF_NORMALIZED: Mapping[str, Any] = {"learning_rate": 0.1}
"""The same for features that sum to 1: the learning rate is divided among them, as it is among tilings."""


def algorithm_defaults(preset: Mapping[str, Any], asked: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings that come with the requested algorithm, over those of a preset for another algorithm.

    A requested learning rate stays constant, unless the algorithm needs averages.
    """
    algorithm = asked.get("algorithm")
    if not isinstance(algorithm, str) or preset.get("algorithm") == algorithm:
        return {}
    own = {name: value for name, value in _OF_ALGORITHM.get(algorithm, {}).items() if not is_set(asked.get(name))}
    rate_is_asked_for = is_set(asked.get("learning_rate")) or is_set(asked.get("learning_rate_schedule"))
    if rate_is_asked_for and algorithm != "off_policy_monte_carlo":
        for name in _AVERAGES:
            own.pop(name, None)
    return own


def weighted_defaults(asked: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings that come with weighted features, those of the requested discretizer; else none."""
    if not uses_weighted(asked.get("discretizer")):
        return {}
    own = {**_OF_WEIGHTED, **_OF_NORMALIZED} if _is_true(asked.get("normalized")) else _OF_WEIGHTED
    return {name: value for name, value in own.items() if not is_set(asked.get(name))}


_SCHEDULES: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "learning_rate": ("learning_rate_schedule", ("min_learning_rate", "learning_rate_warm_up")),
    "epsilon": ("epsilon_schedule", ("min_epsilon", "epsilon_warm_up")),
}
"""For each rate that can fall, the setting that names its schedule, and the settings that apply only to a falling
rate."""


_WITH_RATE = {
    rate: (schedule, *(name for name, option in OPTIONS.items() if option.choice == schedule))
    for rate, (schedule, _) in _SCHEDULES.items()
}
"""For each rate that can fall, the setting that names its schedule, and the options of the schedule."""


def _is_true(value: Any) -> bool:
    """Whether a setting that has not been checked yet is True."""
    return isinstance(value, bool | np.bool_) and bool(value)


def _scale(fields: Mapping[str, Any]) -> tuple[bool, bool]:
    """Returns whether features are weighted, and whether they sum to 1."""
    name = fields["discretizer"]
    return uses_weighted(name), isinstance(name, str) and name == "radial" and _is_true(fields["normalized"])


def rescaled_settings(before: Mapping[str, Any], changes: Mapping[str, Any]) -> set[str]:
    """Returns the names of the settings that mean something else after a change of discretizer, and are not changed.

    Weighted features do not share a step size, and initial weights are no values, unless the features sum to 1. A
    schedule stays if its options are changed.
    """
    if _scale(before) == _scale({**before, **changes}):
        return set()
    schedule, *options = _WITH_RATE["learning_rate"]
    names = {"learning_rate", schedule, *options, "value_learning_rate", "initial_q"}
    if before[schedule] in ("linear", "exponential") and any(is_set(changes.get(name)) for name in options):
        names.discard(schedule)
    return {name for name in names if not is_set(changes.get(name))}


def implied_schedules(asked: Mapping[str, Any], fields: Mapping[str, Any]) -> dict[str, str]:
    """Returns the schedules of the rates that were requested without naming one; see :func:`implied_schedule`.

    Args:
        asked: The requested settings.
        fields: All settings.
    """
    found = {}
    for rate, (name, _) in _SCHEDULES.items():
        schedule = implied_schedule(rate, asked, fields[name])
        if schedule is not None and mismatch(name, schedule, fields) is None:
            found[name] = schedule
    return found


def implied_schedule(rate: str, asked: Mapping[str, Any], otherwise: str | None) -> str | None:
    """Returns the schedule of a rate that was requested without naming one; None if nothing implies one.

    A rate given alone is constant. With a minimum or a warm-up it falls: linearly, unless the rate itself was not
    requested and already falls in another way.

    Args:
        rate: ``"learning_rate"`` or ``"epsilon"``.
        asked: The requested settings.
        otherwise: The schedule of the rate if none was requested.
    """
    name, falling = _SCHEDULES[rate]
    if is_set(asked.get(name)):
        return None
    falls = any(map(is_set, map(asked.get, falling)))
    if is_set(asked.get(rate)):
        return "linear" if falls else "constant"
    return "linear" if falls and otherwise in (None, "constant") else None


def with_implied(init: Callable[..., None], defaults: Mapping[str, Any]) -> Callable[..., None]:
    """Makes a config's constructor suggest the nearest name, and add the settings that follow from those given.

    Args:
        init: The constructor.
        defaults: The default of each setting.
    """

    @wraps(init)
    def checked(self: Any, *args: Any, **settings: Any) -> None:
        check_names(settings, defaults, "Config")
        if (algorithm := settings.get("algorithm")) in PREFERENCES:
            settings.setdefault("exploration", "softmax")
        settings = {**weighted_defaults(settings), **fixed_settings(algorithm), **settings}
        if settings.get("time_aware"):
            settings.setdefault("on_truncation", "terminate")
        settings.update(implied_schedules(settings, {**defaults, **settings}))
        init(self, *args, **settings)

    return checked


def without_rates(start: Mapping[str, Any], asked: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings of a preset without the schedules of the requested rates.

    The schedule of a preset belongs to its rate: a requested rate does not fall because the preset's does.
    """
    left = dict(start)
    for rate, names in _WITH_RATE.items():
        if is_set(asked.get(rate)):
            for name in names:
                left.pop(name, None)
    return left


def with_followers(
    config: Any, changes: Mapping[str, Any], defaults: Mapping[str, Any]
) -> tuple[dict[str, Any], Origin | None]:
    """Returns the changes to a config together with those that follow from them, and the new origin.

    Args:
        config: The config.
        changes: The settings that are changed.
        defaults: The default of each setting.
    """
    own: dict[str, Any] = {}
    origin: Origin | None = config.origin
    if origin is not None and changes.get("env", config.env) != config.env:
        spec = gym.registry.get(config.env.rpartition(":")[2])
        registered = {} if spec is None else spec.kwargs
        kwargs = config.env_kwargs.items()
        own |= {name: defaults[name] for name in (*origin.derived, "preset")}
        own["env_kwargs"] = {
            name: value for name, value in kwargs if name not in registered or registered[name] != value
        }
        origin = None
    algorithm = changes.get("algorithm", config.algorithm)
    own |= {name: defaults[name] for name in freed_settings(config.algorithm, algorithm)}
    rescaled = rescaled_settings(vars(config), changes)
    own |= {name: defaults[name] for name in rescaled}
    chosen = {name: changes.get(name, getattr(config, name)) for name in ("discretizer", "normalized")}
    own |= {name: value for name, value in weighted_defaults(chosen).items() if name in rescaled}
    if changes.get("time_aware", config.time_aware):
        own["on_truncation"] = "terminate"
    elif config.time_aware:
        own["on_truncation"] = defaults["on_truncation"]
    own |= fixed_settings(algorithm)
    return {**own, **changes}, None if origin is None else origin.without(changes)
