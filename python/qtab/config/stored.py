"""The settings of a config as stored in files."""

from collections.abc import Mapping
from typing import Any

from qtab.config.config import DEFAULTS, Config
from qtab.config.functions import STORED
from qtab.config.options import OPTIONS, SETTINGS, fixed_settings

ADDED = tuple(name for name, setting in SETTINGS.items() if setting.added)
"""Settings that earlier versions lack: files store them only if they differ from their defaults."""

IMPLIED = ("model",)
"""Options added to algorithms of earlier versions: files omit values that reproduce the earlier behavior."""


def stored_settings(config: Config) -> dict[str, Any]:
    """Returns the settings of a config by name. A function, which a file cannot store, is replaced by a word."""
    fields: Mapping[str, Any] = {name: getattr(config, name) for name in DEFAULTS}
    kept = {name: value for name, value in fields.items() if name not in ADDED or value != DEFAULTS[name]}
    for name in IMPLIED:
        if kept.get(name) == OPTIONS[name].default:
            del kept[name]
    return {name: STORED if name == "action_mask" and callable(value) else value for name, value in kept.items()}


def corrected_settings(stored: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings of a stored config with the values that were in effect.

    Earlier versions accepted other values of settings that are fixed for an algorithm, and ignored them.
    """
    return {**stored, **fixed_settings(stored.get("algorithm"))}


def implied_settings(config: Config) -> dict[str, Any]:
    """Returns the options that a stored config omits although they apply."""
    return {
        name: OPTIONS[name].default
        for name in IMPLIED
        if getattr(config, name) is None and getattr(config, OPTIONS[name].choice) in OPTIONS[name].values
    }
