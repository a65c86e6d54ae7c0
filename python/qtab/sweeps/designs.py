"""``qtab.designs``: the settings of a sweep as a full grid, as random points or as a Sobol sequence."""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.extras import missing

__all__ = ["grid", "random", "sobol"]

MAX_POINTS = 1_000_000
"""The maximum number of settings; more could fill the memory."""

Space = Mapping[str, Any]
"""Maps each name to ``(low, high)``, ``(low, high, "log")``, a range or a list of choices."""


def grid(values: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Returns every combination of the values; the last name varies fastest.

    Args:
        values: A list of values for each name.

    Raises:
        TypeError: if ``values`` is not a mapping, or the values of a name are not a list.
        ValueError: if there is no name, a name has no value or the same value twice, or there are more than a million
            combinations.
    """
    if not isinstance(values, Mapping):
        raise TypeError(f"grid must map names of settings to lists of values, got {values!r}")
    if not values:
        raise ValueError("grid must name at least one setting to vary, got none")
    for name, choices in values.items():
        if isinstance(choices, (str, bytes)) or not hasattr(choices, "__iter__"):
            raise TypeError(f"grid[{name!r}] must be a list of values, got {choices!r}")
    # An infinite iterator cannot become a list.
    lists = {name: list(itertools.islice(choices, MAX_POINTS + 1)) for name, choices in values.items()}
    combinations = math.prod(map(len, lists.values()))
    if combinations > MAX_POINTS:
        raise ValueError(f"grid must have at most {MAX_POINTS:,} combinations of values, got {combinations:,} or more")
    for name, choices in lists.items():
        if not choices:
            raise ValueError(f"grid[{name!r}] must hold at least one value")
        if len({repr(choice) for choice in choices}) < len(choices):
            raise ValueError(f"grid[{name!r}] must hold different values, got {choices!r}")
    return [dict(zip(lists, point, strict=True)) for point in itertools.product(*lists.values())]


def random(space: Space, points: int, seed: int = 0) -> list[dict[str, Any]]:
    """Returns points drawn independently and uniformly from a space.

    Args:
        space: Maps each name to ``(low, high)``, ``(low, high, "log")`` for a log-uniform distribution, ``range(...)``
            or a list of choices.
        points: The number of points, at most a million.
        seed: The seed of NumPy's ``default_rng``.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    points = checks.integer("points", points, least=1, most=MAX_POINTS)
    _check_space(space)
    rng = np.random.default_rng(checks.integer("seed", seed, least=0))
    return _settings(space, rng.random((points, len(space))))


def sobol(space: Space, points: int, seed: int = 0) -> list[dict[str, Any]]:
    """Returns the points of a scrambled Sobol sequence, which cover a space more evenly than random points.

    Args:
        space: As for :func:`random`.
        points: The number of points, a power of two, at most a million.
        seed: The seed of the scrambling.

    Raises:
        ModuleNotFoundError: without scipy; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    try:
        from scipy.stats import qmc
    except ModuleNotFoundError as error:
        raise missing(error, "stats") from None
    points = checks.integer("points", points, least=1, most=MAX_POINTS)
    if points & (points - 1):
        raise ValueError(f"points must be a power of two for a Sobol design, got {points}")
    _check_space(space)
    rng = np.random.default_rng(checks.integer("seed", seed, least=0))
    return _settings(space, qmc.Sobol(len(space), rng=rng).random(points))


def _check_space(space: Any) -> None:
    message = f"space must map at least one name to (low, high), a range or a list of choices, got {space!r}"
    if not isinstance(space, Mapping):
        raise TypeError(message)
    if not space:
        raise ValueError(message)


def _settings(space: Space, points: NDArray[np.float64]) -> list[dict[str, Any]]:
    return [{name: _value(name, space[name], u) for name, u in zip(space, point, strict=True)} for point in points]


def _value(name: str, axis: Any, u: float) -> Any:
    """Returns the value of an axis at the quantile ``u``, in [0, 1)."""
    if isinstance(axis, list | range):
        if not axis:
            raise ValueError(f"space[{name!r}] must hold at least one choice")
        return axis[int(u * len(axis))]
    if isinstance(axis, tuple) and len(axis) in (2, 3):
        low, high = checks.finite(f"space[{name!r}]", axis[0]), checks.finite(f"space[{name!r}]", axis[1])
        is_log = axis[2:] == ("log",) and low > 0
        if low < high and math.isinf(high / low if is_log else high - low):
            span = "ratio" if is_log else "difference"
            raise ValueError(f"space[{name!r}] must have bounds whose {span} is less than 1.8e308, got {axis!r}")
        if low < high and len(axis) == 2:
            return float(low + (high - low) * u)
        if 0 < low < high and axis[2:] == ("log",):
            return float(low * (high / low) ** u)
    raise ValueError(
        f"space[{name!r}] must be (low, high) with low < high, (low, high, 'log') with 0 < low < high, a range or a "
        f"list of choices, got {axis!r}"
    )


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
