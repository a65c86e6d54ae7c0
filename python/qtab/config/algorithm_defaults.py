"""The defaults of algorithms that differ from the common ones: the book's settings."""

from collections.abc import Mapping
from typing import Any

from qtab.config.options import FIXED, is_set

_AVERAGES: Mapping[str, Any] = {"learning_rate": 1.0, "learning_rate_schedule": "visits"}
"""Averages of returns as values."""

_DEFAULTS: Mapping[str, Mapping[str, Any]] = {
    "monte_carlo": _AVERAGES,
    "monte_carlo_es": {**_AVERAGES, "epsilon": 0.0},  # exploring starts are the only exploration
    "off_policy_monte_carlo": _AVERAGES,
    **{algorithm: fixed.values for algorithm, fixed in FIXED.items()},
}
"""The settings of each algorithm that differ from those of :class:`qtab.Config`."""


def algorithm_defaults(preset: Mapping[str, Any], asked: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings that come with the requested algorithm, over those of a preset for another algorithm.

    A requested learning rate stays constant, unless the algorithm needs averages.
    """
    algorithm = asked.get("algorithm")
    if not isinstance(algorithm, str) or preset.get("algorithm") == algorithm:
        return {}
    own = {name: value for name, value in _DEFAULTS.get(algorithm, {}).items() if not is_set(asked.get(name))}
    rate_is_asked_for = is_set(asked.get("learning_rate")) or is_set(asked.get("learning_rate_schedule"))
    if rate_is_asked_for and algorithm != "off_policy_monte_carlo":
        for name in _AVERAGES:
            own.pop(name, None)
    return own
