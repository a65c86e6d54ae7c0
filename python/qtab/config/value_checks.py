"""The checks of the values of settings: invalid ones are rejected, and NumPy's numbers converted to Python's.

Each check takes the name of the setting, for the message, and the value. It returns the value as the config stores it.
It raises TypeError for a value of the wrong type, and ValueError for one that is out of range.
"""

import math
from collections.abc import Callable, Mapping
from functools import partial
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config.choices import CHOICES

MAX_ACTIONS = 2**16
MAX_TILINGS = 32
MAX_TILES = 2**32 - 1
MAX_BINS = 1_000_000
MAX_FEATURES = 1024
"""The maximum number of weighted features: a step takes time in proportion to it."""
MAX_ROWS = 2**32 - 2

Check: TypeAlias = Callable[[str, Any], Any]


def text(name: str, value: Any) -> str:
    """Returns a string: an environment id, or the name of a preset."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be {'an environment id' if name == 'env' else 'a name'}, got {shown(value)}")
    return value


def real(low: float, high: float) -> Check:
    """Returns the check of a number in [``low``, ``high``]."""
    return partial(checks.real, low=low, high=high)


def above_zero(name: str, value: Any) -> float:
    """Returns a finite number above 0."""
    number = checks.finite(name, value)
    if number <= 0:
        raise ValueError(f"{name} must be above 0, got {shown(value)}")
    return number


def not_negative(name: str, value: Any) -> float:
    """Returns a finite number that is not negative."""
    number = checks.finite(name, value)
    if number < 0:
        raise ValueError(f"{name} must not be negative, got {shown(value)}")
    return number


def integer(least: int, most: int | None = None) -> Check:
    """Returns the check of an integer in [``least``, ``most``]."""
    return partial(checks.integer, least=least, most=most)


order = integer(1, MAX_FEATURES - 1)
"""Returns the order of a basis: with one component and order n there are n + 1 features."""
count: Check = partial(checks.count, least=1)
"""Returns a number of episodes or steps: at least 1."""


def choice(name: str, value: Any) -> str:
    """Returns one of the possible values of the setting."""
    return checks.choice(name, value, CHOICES[name])


def keywords(name: str, value: Any) -> dict[str, Any]:
    """Returns a copy of keyword arguments."""
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise TypeError(f"{name} must map names to values, got {shown(value)}")
    return dict(value)


def each(name: str, value: Any, check: Check = checks.finite) -> tuple[Any, ...]:
    """Returns a number for each component of the observation, each of them checked."""
    if not checks.is_sequence(value):
        raise TypeError(f"{name} must hold a number for each component of the observation, got {shown(value)}")
    return tuple(map(partial(check, name), value))


def scale(name: str, value: Any) -> tuple[float, ...]:
    """Returns a positive number for each component of the observation."""
    numbers = each(name, value)
    if min(numbers, default=1.0) <= 0:
        raise ValueError(f"{name} must hold positive numbers, got {shown(value)}")
    return numbers


def counts(least: int, most: int) -> Check:
    """Returns the check of an integer for each component, or of a single one for all."""
    return partial(_for_components, check=integer(least, most))


def sizes(low: float, high: float) -> Check:
    """Returns the check of a number in [``low``, ``high``] for each component, or of a single one for all."""
    return partial(_for_components, check=real(low, high))


def _for_components(name: str, value: Any, check: Check) -> tuple[Any, ...]:
    numbers = each(name, value if hasattr(value, "__iter__") else (value,), check)
    if not numbers:
        fitting = (
            "the number of cells along each axis of the table, such as (19, 15)"
            if name == "shape"
            else "a number for each component of the observation, or one for all"
        )
        raise ValueError(f"{name} must hold {fitting}, got ()")
    return numbers


def edges(name: str, value: Any) -> tuple[tuple[float, ...], ...]:
    """Returns ascending numbers for each component of the observation."""
    if not checks.is_sequence(value):
        raise TypeError(f"{name} must hold a row of numbers for each component of the observation, got {shown(value)}")
    rows = tuple(each(name, row) for row in value)
    if any(left >= right for row in rows for left, right in pairwise(row)):
        raise ValueError(f"{name} must hold rows of ascending numbers, got {shown(value)}")
    return rows


def _action(name: str, action: Any) -> float | tuple[float, ...]:
    if isinstance(action, list | tuple | np.ndarray) and not (isinstance(action, np.ndarray) and action.ndim != 1):
        return tuple(checks.finite(name, number) for number in action)
    return checks.finite(name, action)


def actions(name: str, value: Any) -> Any:
    """Returns the number of actions along each component, or the actions themselves."""
    if hasattr(value, "__index__") and not np.ndim(value):
        return checks.integer(name, value, least=2, most=MAX_ACTIONS)
    if not checks.is_sequence(value):
        raise TypeError(f"{name} must be an integer, or hold the actions themselves, got {shown(value)}")
    listed = tuple(_action(name, action) for action in value)
    if not listed:
        raise ValueError(f"{name} must hold at least one action, got {shown(value)}")
    return listed


def initial_q(name: str, value: Any) -> float | tuple[float, float] | NDArray[np.float64]:
    """Returns a number, a range, or a table as a read-only array of float64."""
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
    """Whether NumPy converts an array to floats without changing its meaning, as it would for strings and dates."""
    if array.dtype.kind == "O":
        return all(hasattr(part, "__float__") and not isinstance(part, str | bytes) for part in array.flat)
    return array.dtype.kind in "iuf"


def check_limits(low: tuple[float, ...] | None, high: tuple[float, ...] | None) -> None:
    """Checks that upper limits lie above lower ones, if both are given.

    Raises:
        ValueError: if one does not, or their numbers differ.
    """
    if low is None or high is None:
        return
    if len(low) != len(high):
        raise ValueError(f"high must hold as many numbers as low, got {shown(high)}")
    if not all(first < last for first, last in zip(low, high, strict=True)):
        raise ValueError(f"high must lie above low = {low!r}, got {shown(high)}")
