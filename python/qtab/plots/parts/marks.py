"""Lines at known returns, such as Gymnasium's threshold, and the episodes that a point of a curve averages."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat

from qtab._utils import checks
from qtab.plots.parts.colors import readable, text_color
from qtab.results.summary import default_block

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

OPTIMUM_COLOR = "#a3262f"
CLOSE = 0.005
"""A threshold at a smaller distance from the optimum, relative to the axis, is the same line."""
_OPTIMUM = "qtab-optimum"
MAX_STRETCH = 2.0
"""A threshold that would stretch the axis by more than this is only drawn if the user asks for it."""


def check_optimum(optimum: "Optimum | float | None") -> None:
    """Checks the argument ``optimum``.

    Raises:
        TypeError: if it is neither None, a number nor a result of :func:`qtab.optimum`.
        ValueError: if it is NaN or infinite.
    """
    if optimum is None or hasattr(optimum, "expected_return"):
        return
    if isinstance(optimum, bool) or not hasattr(optimum, "__float__"):
        raise TypeError(f"optimum must be a number or a result of qtab.optimum, got {optimum!r}")
    checks.finite("optimum", optimum)


def check_threshold(threshold: float | Literal[False] | None) -> None:
    """Checks the argument ``threshold``.

    Raises:
        TypeError: if it is neither None, False nor a number.
        ValueError: if it is NaN or infinite.
    """
    if threshold is not None and threshold is not False:
        checks.finite("threshold", threshold)


def mark_optimum(ax: "Axes", optimum: "Optimum | float | None") -> None:
    """Draws a dashed horizontal line at an optimum or a return, with the number in the legend."""
    if optimum is None:
        return
    value, label = (
        (float(optimum), "optimum") if isinstance(optimum, SupportsFloat) else (optimum.expected_return, optimum.label)
    )
    if any(line.get_ydata()[0] == value for line in _optima(ax)):  # a second plot on the same axes
        return
    style: dict[str, Any] = {"color": readable(OPTIMUM_COLOR, ax), "linestyle": (0, (5, 3)), "linewidth": 1.5}
    _line(ax, "y", value, f"{label} {value:.4g}", {**style, "gid": _OPTIMUM})


def _optima(ax: "Axes") -> list[Any]:
    """Returns the lines at an optimum."""
    return [line for line in ax.get_lines() if line.get_gid() == _OPTIMUM]


def mark_threshold(
    ax: "Axes", threshold: float | Literal[False] | None, known: float | None = None, axis: Literal["x", "y"] = "y"
) -> None:
    """Draws a dotted line at a threshold, with the number in the legend, or names the line of an optimum that is there.

    Args:
        ax: The axes, with all data drawn.
        threshold: The return to mark. None means the known one, if it is not far from the data; False means none.
        known: The threshold that applies to the data, if there is one.
        axis: The axis that shows returns.
    """
    if threshold is False:
        return
    if threshold is None:
        low, high = sorted(ax.get_ylim() if axis == "y" else ax.get_xlim())
        if known is None or max(high, known) - min(low, known) > MAX_STRETCH * (high - low):
            return
        threshold = known
    value = float(threshold)
    if axis == "y":
        low, high = sorted(ax.get_ylim())
        for line in _optima(ax):
            optimum = line.get_ydata()[0]
            if abs(optimum - value) <= CLOSE * (high - low):
                line.set_label(_both_names(str(line.get_label()), f"threshold {value:g}"))
                return
    style: dict[str, Any] = {"color": text_color(), "alpha": 0.7, "linestyle": (0, (1, 1.5)), "linewidth": 1.5}
    _line(ax, axis, value, f"threshold {value:g}", style)


def _both_names(optimum: str, threshold: str) -> str:
    """Returns the name of a line at an optimum and a threshold, with one number if both have the same one."""
    if threshold in optimum:  # a second plot on the same axes
        return optimum
    name, _, number = optimum.rpartition(" ")
    return f"{name} and {threshold}" if threshold.endswith(f" {number}") else f"{optimum}, {threshold}"


def _line(ax: "Axes", axis: Literal["x", "y"], value: float, label: str, style: dict[str, Any]) -> None:
    if label not in [line.get_label() for line in ax.get_lines()]:  # a second plot on the same axes
        draw = ax.axhline if axis == "y" else ax.axvline
        draw(value, label=label, zorder=4, **style)


_SHORT_BLOCKS = (50, 20, 10, 5, 2)
_MIN_POINTS = 20


def fitting_block(episodes: int) -> int:
    """Returns the default number of episodes in a block: 100, and more for runs of more than 10,000 episodes.

    Runs of fewer than 2,000 episodes have at least twenty shorter blocks, and those of fewer than forty have blocks of
    one.
    """
    if episodes >= _MIN_POINTS * 100:
        return default_block(episodes)
    return next((block for block in _SHORT_BLOCKS if episodes >= _MIN_POINTS * block), 1)


def common_block(block: int | None, lengths: Sequence[int], units: Sequence[int]) -> int:
    """Returns the number of episodes in a block of several learning curves.

    Args:
        block: The user's choice; None fits the block to the shortest curve.
        lengths: The number of episodes of each curve.
        units: The number of episodes that each point of a curve already averages.

    Raises:
        TypeError: if ``block`` is not an integer.
        ValueError: if it is longer than a curve, or not a multiple of a unit; without it, if no block fits all curves.
    """
    shortest, unit = min(lengths), math.lcm(*units)
    if block is None:
        if unit > shortest:
            raise ValueError(
                f"returns must have at least {unit:,} episodes, the block of the sweep that is drawn with them, "
                f"got {shortest:,}"
            )
        rounded = math.ceil(fitting_block(shortest) / unit) * unit
        return rounded if rounded <= shortest else unit
    block = checks.integer("block", block, least=1, most=shortest)
    if block % unit:
        raise ValueError(f"block must be a multiple of the sweep's block, {unit:,}, got {block:,}")
    return block
