"""Lines at known returns, such as Gymnasium's threshold, and the episodes that a point of a curve averages."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
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
_ATTRIBUTE = "_qtab_mark"
"""The attribute of a line that says what it stands for."""
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


@dataclass(frozen=True)
class _Mark:
    """What a line stands for: an optimum, thresholds, or both."""

    axis: Literal["x", "y"]
    value: float
    optimum: str = ""
    """The name of the optimum; empty without one."""
    thresholds: tuple[float, ...] = ()

    @property
    def label(self) -> str:
        """Returns the names with their numbers; an optimum and a threshold with the same number share it."""
        numbers = [f"{threshold:g}" for threshold in self.thresholds]
        names = [f"threshold {number}" for number in numbers]
        if not self.optimum:
            return ", ".join(names)
        shown = f"{self.value:.4g}"
        if shown in numbers:
            both = names.pop(numbers.index(shown))
            return ", ".join([f"{self.optimum} and {both}", *names])
        return ", ".join([f"{self.optimum} {shown}", *names])


def mark_optimum(ax: "Axes", optimum: "Optimum | float | None") -> None:
    """Draws a dashed horizontal line at an optimum or a return, with the number in the legend.

    It replaces the line of a threshold that is there, and then has both names.
    """
    if optimum is None:
        return
    value, name = (
        (float(optimum), "optimum") if isinstance(optimum, SupportsFloat) else (optimum.expected_return, optimum.label)
    )
    new, replaced = _Mark("y", value, name), []
    for line, mark in _marks(ax, "y"):
        same_name = mark.optimum == name and f"{mark.value:.4g}" == f"{value:.4g}"
        if mark.optimum and (mark.value == value or same_name):  # a second plot on the same axes
            return
        if not mark.optimum and _close(ax, mark.value, value):
            new = replace(new, thresholds=new.thresholds + mark.thresholds)
            replaced.append(line)
    for line in replaced:
        line.remove()
    _line(ax, new, {"color": readable(OPTIMUM_COLOR, ax), "linestyle": (0, (5, 3))})


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
    value, marks = float(threshold), _marks(ax, axis)
    drawn = [f"{other:g}" for _, mark in marks for other in mark.thresholds]
    if f"{value:g}" in drawn:  # a second plot on the same axes
        return
    for line, mark in marks:
        if mark.optimum and _close(ax, mark.value, value):
            _name(line, replace(mark, thresholds=(*mark.thresholds, value)))
            return
    style = {"color": text_color(), "alpha": 0.7, "linestyle": (0, (1, 1.5))}
    _line(ax, _Mark(axis, value, thresholds=(value,)), style)


def _marks(ax: "Axes", axis: Literal["x", "y"]) -> list[tuple[Any, _Mark]]:
    """Returns the lines on an axis and what they stand for."""
    found = [(line, getattr(line, _ATTRIBUTE, None)) for line in ax.get_lines()]
    return [(line, mark) for line, mark in found if mark is not None and mark.axis == axis]


def _close(ax: "Axes", one: float, other: float) -> bool:
    low, high = sorted(ax.get_ylim())
    return abs(one - other) <= CLOSE * (high - low)


def _line(ax: "Axes", mark: _Mark, style: dict[str, Any]) -> None:
    draw = ax.axhline if mark.axis == "y" else ax.axvline
    _name(draw(mark.value, linewidth=1.5, zorder=4, **style), mark)


def _name(line: Any, mark: _Mark) -> None:
    setattr(line, _ATTRIBUTE, mark)
    line.set_label(mark.label)


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
