"""Lines at known returns: an optimum, and the threshold at which Gymnasium considers an environment solved."""

from typing import TYPE_CHECKING, Any, Literal, SupportsFloat

from qtab._utils import checks
from qtab.plots.colors import readable, text_color

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

OPTIMUM_COLOR = "#a3262f"
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
    style: dict[str, Any] = {"color": readable(OPTIMUM_COLOR, ax), "linestyle": (0, (5, 3)), "linewidth": 1.5}
    _line(ax, "y", value, f"{label} {value:.4g}", style)


def mark_threshold(
    ax: "Axes", threshold: float | Literal[False] | None, known: float | None = None, axis: Literal["x", "y"] = "y"
) -> None:
    """Draws a dotted line at a threshold, with the number in the legend.

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
    style: dict[str, Any] = {"color": text_color(), "alpha": 0.7, "linestyle": (0, (1, 1.5)), "linewidth": 1.5}
    _line(ax, axis, value, f"threshold {value:g}", style)


def _line(ax: "Axes", axis: Literal["x", "y"], value: float, label: str, style: dict[str, Any]) -> None:
    if label not in [line.get_label() for line in ax.get_lines()]:  # a second plot on the same axes
        draw = ax.axhline if axis == "y" else ax.axvline
        draw(value, label=label, zorder=4, **style)
