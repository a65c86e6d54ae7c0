"""The checks of the settings: bad values are refused, NumPy's numbers become Python's."""

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config.action_mask import mask_setting
from qtab.config.choices import CHOICES
from qtab.config.discretizer import uses_tiles
from qtab.config.keyed_discretizers import check_limits, checked_discretizer
from qtab.config.options import OPTIONS, PREFERENCES, check_options, other_choice

LARGEST_MT19937_SEED = 2**32 - 1
MAX_TILINGS = 32
MAX_TILES = 2**32 - 1
MAX_BINS = 1_000_000
MAX_ACTIONS = 2**16
MAX_ROWS = 2**32 - 2


def validated(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the fields of a config, checked. None stays None where it means "not given".

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range, or that does not go with another.
    """
    checked = dict(fields)
    for name, check in _CHECKS.items():
        if fields[name] is not None or name not in _OPTIONAL:
            checked[name] = check(name, fields[name])
    if checked["seed"] is not None:
        most = LARGEST_MT19937_SEED if checked["bit_generator"] == "MT19937" else None
        checked["seed"] = checks.integer("seed", checked["seed"], least=0, most=most)
    check_options(checked)
    missing = isinstance(checked["initial_q"], np.ndarray) and np.isneginf(checked["initial_q"]).any()
    if missing and uses_tiles(checked["discretizer"]):
        raise ValueError(other_choice("discretizer", "tiles", ("tiles",), "for an initial_q that contains -inf"))
    most_rate = 2 if uses_tiles(checked["discretizer"]) else 1
    if checked["algorithm"] in PREFERENCES:
        _not_negative("learning_rate", checked["learning_rate"])
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


def _text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name} must be {'an environment id' if name == 'env' else 'a name'}, got {shown(value)}")
    return value


def _real(low: float, high: float) -> Callable[[str, Any], float]:
    return lambda name, value: checks.real(name, value, low, high)


def _above_zero(name: str, value: Any) -> float:
    number = checks.finite(name, value)
    if number <= 0:
        raise ValueError(f"{name} must be above 0, got {shown(value)}")
    return number


def _not_negative(name: str, value: Any) -> float:
    number = checks.finite(name, value)
    if number < 0:
        raise ValueError(f"{name} must not be negative, got {shown(value)}")
    return number


def _flag(name: str, value: Any) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"{name} must be True or False, got {shown(value)}")
    return bool(value)


def _integer(least: int, most: int | None = None) -> Callable[[str, Any], int]:
    return lambda name, value: checks.integer(name, value, least, most)


def _count(name: str, value: Any) -> int:
    return checks.count(name, value, least=1)


def _choice(name: str, value: Any) -> str:
    return checks.choice(name, value, CHOICES[name])


def _keywords(name: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise TypeError(f"{name} must map names to values, got {shown(value)}")
    return dict(value)


def _each(check: Callable[[str, Any], Any]) -> Callable[[str, Any], tuple[Any, ...]]:
    def checked(name: str, value: Any) -> tuple[Any, ...]:
        if not checks.is_sequence(value):
            raise TypeError(f"{name} must hold a number for each component of the observation, got {shown(value)}")
        return tuple(check(name, number) for number in value)

    return checked


def _scale(name: str, value: Any) -> tuple[float, ...]:
    scale = _each(checks.finite)(name, value)
    if any(number <= 0 for number in scale):
        raise ValueError(f"{name} must hold positive numbers, got {shown(value)}")
    return scale


def _counts(least: int, most: int) -> Callable[[str, Any], tuple[int, ...]]:
    def checked(name: str, value: Any) -> tuple[int, ...]:
        counts = _each(_integer(least, most))(name, value if hasattr(value, "__iter__") else (value,))
        if not counts:
            fitting = (
                "the number of cells along each axis of the table, such as (19, 15)"
                if name == "shape"
                else "a number for each component of the observation, or one for all"
            )
            raise ValueError(f"{name} must hold {fitting}, got ()")
        return counts

    return checked


def _edges(name: str, value: Any) -> tuple[tuple[float, ...], ...]:
    if not checks.is_sequence(value):
        raise TypeError(f"{name} must hold a row of numbers for each component of the observation, got {shown(value)}")
    rows = tuple(_each(checks.finite)(name, row) for row in value)
    if any(left >= right for row in rows for left, right in pairwise(row)):
        raise ValueError(f"{name} must hold rows of ascending numbers, got {shown(value)}")
    return rows


def _action(name: str, action: Any) -> float | tuple[float, ...]:
    if isinstance(action, list | tuple | np.ndarray) and not (isinstance(action, np.ndarray) and action.ndim != 1):
        return tuple(checks.finite(name, number) for number in action)
    return checks.finite(name, action)


def _actions(name: str, value: Any) -> Any:
    if hasattr(value, "__index__") and not np.ndim(value):
        return checks.integer(name, value, least=2, most=MAX_ACTIONS)
    if not checks.is_sequence(value):
        raise TypeError(f"{name} must be an integer, or hold the actions themselves, got {shown(value)}")
    listed = tuple(_action(name, action) for action in value)
    if not listed:
        raise ValueError(f"{name} must hold at least one action, got {shown(value)}")
    return listed


def _initial_q(name: str, value: Any) -> float | tuple[float, float] | NDArray[np.float64]:
    if isinstance(value, tuple | list) and len(value) == 2 and not any(hasattr(part, "__len__") for part in value):
        low, high = (checks.finite(name, bound) for bound in value)
        if low > high:
            raise ValueError(f"{name} must be a range (low, high) with low <= high, got {shown(value)}")
        if not math.isfinite(high - low):
            raise ValueError(f"{name} must be a range (low, high) with a finite width, got {shown(value)}")
        return low, high
    if hasattr(value, "__float__") and not isinstance(value, bool) and np.ndim(value) == 0:
        return checks.finite(name, value)
    if not isinstance(value, np.ndarray | list):
        raise TypeError(f"{name} must be a range (low, high), a number or a table, got {shown(value)}")
    try:
        given = np.asarray(value)
        if not _holds_numbers(given):
            raise TypeError
        table = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        what = f"an array of {value.dtype}" if isinstance(value, np.ndarray) else shown(value)
        raise TypeError(f"{name} must be a range (low, high) or a table of numbers, got {what}") from None
    if not (np.isfinite(table) | np.isneginf(table)).all():
        raise ValueError(f"{name} must hold finite numbers (or -inf: no such action), got a table with nan or infinity")
    if table.size and table.ndim and np.isneginf(table).all(axis=-1).any():
        raise ValueError(f"{name} must leave every state at least one action, got a row of -inf only")
    table.flags.writeable = False
    return table


def _holds_numbers(array: NDArray[Any]) -> bool:
    """Whether NumPy converts an array to floats without a change of meaning, as it would make of texts and dates."""
    if array.dtype.kind == "O":
        return all(hasattr(part, "__float__") and not isinstance(part, str | bytes) for part in array.flat)
    return array.dtype.kind in "iuf"


_CHECKS: Mapping[str, Callable[[str, Any], Any]] = {
    **dict.fromkeys(CHOICES, _choice),
    "discretizer": lambda name, value: checked_discretizer(name, value, _CHECKS),
    "shape": _counts(1, checks.LARGEST_COUNT),
    "max_rows": _integer(1, MAX_ROWS),
    "env": _text,
    "env_kwargs": _keywords,
    "episodes": _count,
    "learning_rate": checks.finite,  # its range depends on the discretizer
    "discount": _real(0, 1),
    "min_learning_rate": _not_negative,
    "learning_rate_decay": _real(0, 1),
    "learning_rate_warm_up": _integer(0, checks.LARGEST_COUNT),
    "epsilon": _real(0, 1),
    "min_epsilon": _real(0, 1),
    "epsilon_decay": _real(0, 1),
    "epsilon_warm_up": _integer(0, checks.LARGEST_COUNT),
    "temperature": _above_zero,
    "confidence": _not_negative,
    "baseline": _flag,
    "value_learning_rate": checks.finite,  # as for the learning rate
    "trace_decay": _real(0, 1),
    "trace_cutoff": _real(0, 1),
    "n_steps": _integer(1, 1_000_000),
    "sigma": _real(0, 1),
    "planning_steps": _integer(0, 1_000_000),
    "time_weight": _not_negative,
    "priority_threshold": _not_negative,
    "reward_learning_rate": _real(0, 1),
    "scale": _scale,
    "tilings": _integer(1, MAX_TILINGS),
    "tiles": _counts(1, MAX_TILES),
    "hashed_rows": _integer(1, 2**32 - 1),
    "bins": _counts(1, MAX_BINS),
    "edges": _edges,
    "low": _each(checks.finite),
    "high": _each(checks.finite),
    "count_bonus": _not_negative,
    "actions": _actions,
    "action_mask": mask_setting,
    "initial_q": _initial_q,
    "max_episode_steps": _count,
    "time_aware": _flag,
    "preset": _text,
}
_OPTIONAL = OPTIONS.keys() - {"scale"} | {"actions", "max_episode_steps", "preset"}
