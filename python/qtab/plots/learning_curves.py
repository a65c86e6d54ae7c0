"""The learning curve of many runs with a confidence interval."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from qtab.plots.axes import axes_or_new, color, finish, mark_optimum

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

MAX_SINGLE_RUNS = 200
"""The maximum number of single runs that are drawn behind the statistic."""


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
    """Draws a statistic over the runs with its bootstrap interval, in front of the single runs.

    Args:
        returns: (runs, episodes), such as ``runs.episode_returns``.
        ax: The axes to draw on; None creates a new figure.
        block: The number of episodes in a block. Each point shows the mean returns of one block.
        statistic: The statistic over the runs: ``"mean"``, ``"median"`` or ``"iqm"``.
        confidence: The coverage probability of the interval, in [0, 1].
        label: The name in the legend.
        index: The index of the color. Settings on the same axes need different ones.
        optimum: A result of :func:`qtab.optimum`, or a return, to mark by a dashed line with its number in the legend.
        title: The title of the axes.

    Raises:
        ModuleNotFoundError: without matplotlib or SciPy; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    from qtab import stats

    points = stats.curve(returns, block=block, statistic=statistic, confidence=confidence)
    ax = axes_or_new(ax)
    runs = np.atleast_2d(np.asarray(returns, dtype=np.float64))
    x = block * (np.arange(len(points)) + 1)
    means = runs[:, : x[-1]].reshape(len(runs), -1, block).mean(axis=2)
    faint: dict[str, Any] = {"color": color(index), "linewidth": 0.6, "alpha": max(0.04, min(0.4, 8 / len(runs)))}
    ax.plot(x, means[:MAX_SINGLE_RUNS].T, rasterized=True, zorder=1, **faint)
    band = f"{confidence:.0%} interval"
    low, high = [point.low for point in points], [point.high for point in points]
    ax.fill_between(x, low, high, color=color(index), alpha=0.35, linewidth=0, zorder=2)
    name = f"{label + ': ' if label else ''}{statistic} of {len(runs)} run{'' if len(runs) == 1 else 's'}, {band}"
    ax.plot(x, [point.estimate for point in points], color=color(index), linewidth=2.2, label=name, zorder=3)
    mark_optimum(ax, optimum)
    ax.xaxis.set_major_formatter("{x:,.0f}")
    return finish(ax, "Episode", f"Return, mean of {block:,} episode{'' if block == 1 else 's'}", title)
