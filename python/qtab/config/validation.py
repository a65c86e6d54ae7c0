"""The check of a whole config: each setting by itself, and settings that limit others."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config.compatibility import check_options, other_choice
from qtab.config.discretizer import uses_tiles
from qtab.config.keyed_discretizers import check_limits, checked_discretizer
from qtab.config.options import OPTIONS, PREFERENCES, SETTINGS
from qtab.config.value_checks import not_negative

LARGEST_MT19937_SEED = 2**32 - 1


def validated(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the checked fields of a config. None stays None if it means "not given".

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range, or incompatible with another.
    """
    checked = dict(fields)
    if fields["seed"] is not None and fields["bit_generator"] == "MT19937":
        checks.integer("seed", fields["seed"], least=0, most=LARGEST_MT19937_SEED)
    for name, setting in SETTINGS.items():
        if fields[name] is not None or not setting.may_be_none:
            checked[name] = setting.check(name, fields[name])
    checked["discretizer"] = checked_discretizer("discretizer", fields["discretizer"])
    check_options(checked)
    missing = isinstance(checked["initial_q"], np.ndarray) and np.isneginf(checked["initial_q"]).any()
    if missing and uses_tiles(checked["discretizer"]):
        raise ValueError(other_choice("discretizer", "tiles", ("tiles",), "for an initial_q that contains -inf"))
    most_rate = 2 if uses_tiles(checked["discretizer"]) else 1
    if checked["algorithm"] in PREFERENCES:
        not_negative("learning_rate", checked["learning_rate"])
    else:
        checks.real("learning_rate", checked["learning_rate"], 0, most_rate)
    if checked["value_learning_rate"] is not None:
        checks.real("value_learning_rate", checked["value_learning_rate"], 0, most_rate)
    _at_most(checked, "min_epsilon", "epsilon", OPTIONS["epsilon"].default)
    _at_most(checked, "min_learning_rate", "learning_rate", None)
    for name in ("epsilon_warm_up", "learning_rate_warm_up"):
        if checked[name] is not None and checked[name] >= checked["episodes"]:
            raise ValueError(f"{name} must be less than episodes = {checked['episodes']}, got {shown(checked[name])}")
    check_limits(checked["low"], checked["high"])
    return checked


def _at_most(fields: Mapping[str, Any], name: str, limit: str, default: float | None) -> None:
    most = default if fields[limit] is None else fields[limit]
    if fields[name] is not None and fields[name] > most:
        raise ValueError(f"{name} must lie in [0, {limit} = {most:g}], got {shown(fields[name])}")
