"""The settings of a config as files hold them."""

from collections.abc import Mapping
from typing import Any

from qtab.config.action_mask import STORED
from qtab.config.config import DEFAULTS, Config

ADDED = ("action_mask", "shape", "max_rows", "baseline", "value_learning_rate", "confidence")
"""Settings that earlier versions do not have: files hold them only where they differ from their defaults."""


def stored_settings(config: Config) -> dict[str, Any]:
    """Returns the settings of a config by name. A function, which no file can hold, is replaced by a word."""
    fields: Mapping[str, Any] = {name: getattr(config, name) for name in DEFAULTS}
    kept = {name: value for name, value in fields.items() if name not in ADDED or value != DEFAULTS[name]}
    return {name: STORED if name == "action_mask" and callable(value) else value for name, value in kept.items()}
