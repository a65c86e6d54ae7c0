"""Merging the layers of requested settings into one checked config: the preset lowest, then files, then keywords."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from qtab._utils.shown import shown
from qtab.config.algorithm_defaults import algorithm_defaults
from qtab.config.compatibility import applicable
from qtab.config.config import DEFAULTS, Config
from qtab.config.options import is_set
from qtab.config.presets import preset
from qtab.config.rates import implied_schedules, without_rates
from qtab.config.unknown import check_names


def merge_layers(*layers: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the requested settings, with later layers over earlier ones. Their values are not checked.

    Raises:
        TypeError: for an unknown setting.
    """
    asked: dict[str, Any] = {}
    for layer in layers:
        check_names(layer, DEFAULTS)
        asked.update(layer)
    return asked


def config_of(env: str, asked: Mapping[str, Any]) -> Config:
    """Returns the config of an environment: the requested settings over those of its preset.

    A preset is a starting point: its settings that do not apply to the requested ones are left out, and a requested
    algorithm brings its own defaults.

    Raises:
        TypeError: for a setting of the wrong type.
        ValueError: for a setting out of range, or an unknown preset.
    """
    name = asked.get("preset")
    if name is not None and not isinstance(name, str):
        raise TypeError(f"preset must be a name, got {shown(name)}")
    name, start = preset(env, name)
    own = algorithm_defaults(start, asked)
    start = without_rates(start, asked)
    own = {**implied_schedules(asked, {**DEFAULTS, **start, **own, **asked}), **own}
    start = applicable(start, {**DEFAULTS, **start, **own, **asked})
    own = applicable(own, {**DEFAULTS, **start, **own, **asked})
    with naming_preset(name, {setting: value for setting, value in start.items() if setting not in own}, asked):
        return Config(**{**start, **own, **asked, "env": env, "preset": name})


@contextmanager
def naming_preset(name: str | None, settings: Mapping[str, Any], asked: Mapping[str, Any]) -> Iterator[None]:
    """Adds to an error about a preset's value that it comes from the preset.

    Args:
        name: The name of the preset.
        settings: The settings used from the preset.
        asked: The requested settings.
    """
    try:
        yield
    except ValueError as error:
        setting = str(error).split(" ", 1)[0]
        if name is None or setting not in settings or is_set(asked.get(setting)):
            raise
        raise ValueError(f"{error}; this is the {setting} of preset {name!r}; give another one") from None


def merge(env: str, *layers: Mapping[str, Any]) -> Config:
    """Returns the config of an environment: its preset, then each layer over the previous one.

    Raises:
        TypeError: for an unknown setting, or one of the wrong type.
        ValueError: for a setting out of range, or an unknown preset.
    """
    return config_of(env, merge_layers(*layers))
