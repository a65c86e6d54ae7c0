"""The changes that findings advise: each is one that ``Config.replace`` accepts for the run's config."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from qtab.config import DEFAULTS, Config
from qtab.config.options import OPTIONS, is_set
from qtab.config.validation import mismatch

_LOWEST = {"min_epsilon": "epsilon", "min_learning_rate": "learning_rate"}
"""The lower limits of rates that fall."""
_OF_SHAPES = {"discretizer", *(name for name, option in OPTIONS.items() if option.choice == "discretizer")} - {
    *("low", "high")
}
"""The settings on which the shape of a table depends."""


def change(config: Config, **settings: Any) -> Mapping[str, Any] | None:
    """Returns settings to try, completed by those that have to change with them, or None if the config refuses them.

    Options that no longer apply are reset, and the lower limit of a rate stays the same fraction of it.

    Args:
        config: The config of a run.
        **settings: The settings to change, as keyword arguments of :func:`qtab.train`.
    """
    given = dict(settings)
    fields = {**vars(config), **given}
    for lowest, rate in _LOWEST.items():
        least, before, after = fields[lowest], getattr(config, rate), fields[rate]
        if lowest not in settings and least and before and after is not None and after < before:
            given[lowest] = fields[lowest] = least * after / before
    for name in (*OPTIONS, "terminal_update"):
        if name not in settings and is_set(fields[name]) and mismatch(name, fields[name], fields):
            given[name] = fields[name] = DEFAULTS[name]
    if isinstance(config.initial_q, np.ndarray) and not given.keys().isdisjoint(_OF_SHAPES):
        return None  # the initial table would no longer fit
    try:
        changed = config.replace(**given)
    except (TypeError, ValueError):
        return None
    return None if changed == config else given


def changes(config: Config, *candidates: Mapping[str, Any]) -> tuple[Mapping[str, Any], ...]:
    """Returns the candidates that the config of a run accepts, completed as by :func:`change`."""
    return given(change(config, **settings) for settings in candidates)


def given(candidates: Iterable[Mapping[str, Any] | None]) -> tuple[Mapping[str, Any], ...]:
    """Returns the candidates that are not None."""
    return tuple(candidate for candidate in candidates if candidate is not None)
