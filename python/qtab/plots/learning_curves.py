"""The learning curve of many runs."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from qtab.plots.axes import color, finish, mark_optimum, own_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

MOST_SINGLE_RUNS = 200
"""More single runs than this would only blacken the picture."""


def learning_curves(
    returns: ArrayLike,
    ax: "Axes | None" = None,
    *,
    block: int = 100,
    statistic: str = "mean",
    confidence: float = 0.95,
    label: str | None = None,
    index: int = 0,
    optimum: "Optimum | float | None" = None,
    title: str = "",
) -> "Axes":
    """Draws a statistic over the runs with its bootstrap interval, the single runs faint behind it.

    Args:
        returns: (runs, episodes), such as ``runs.episode_returns``.
        ax: Where to draw; None makes a figure of its own.
        block: Each point is over so many episodes.
        statistic: ``"mean"``, ``"median"`` or ``"iqm"`` over the runs.
        confidence: Of the interval.
        label: For the legend.
        index: Which colour: a number for each setting drawn on the same axes.
        optimum: What :func:`qtab.optimum` found, or a return: a dashed line, its number in the legend.
        title: The picture's.

    Raises:
        ModuleNotFoundError: without matplotlib or scipy; it names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    from qtab import stats

    points = stats.curve(returns, block=block, statistic=statistic, confidence=confidence)
    ax = own_axes(ax)
    runs = np.atleast_2d(np.asarray(returns, dtype=np.float64))
    x = block * (np.arange(len(points)) + 1)
    means = runs[:, : x[-1]].reshape(len(runs), -1, block).mean(axis=2)
    faint: dict[str, Any] = {"color": color(index), "linewidth": 0.6, "alpha": max(0.04, min(0.4, 8 / len(runs)))}
    ax.plot(x, means[:MOST_SINGLE_RUNS].T, rasterized=True, zorder=1, **faint)
    band = f"{confidence:.0%} interval"
    low, high = [point.low for point in points], [point.high for point in points]
    ax.fill_between(x, low, high, color=color(index), alpha=0.35, linewidth=0, zorder=2)
    name = f"{label + ': ' if label else ''}{statistic} of {len(runs)} runs, {band}"
    ax.plot(x, [point.estimate for point in points], color=color(index), linewidth=2.2, label=name, zorder=3)
    mark_optimum(ax, optimum)
    ax.xaxis.set_major_formatter("{x:,.0f}")
    return finish(ax, "Episode", f"Return, mean of {block} episodes", title)
