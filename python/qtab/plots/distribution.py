"""The distribution of the final returns of many runs."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from qtab.plots.axes import axes_or_new, color, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def distribution(
    returns: ArrayLike | Mapping[str, ArrayLike],
    ax: "Axes | None" = None,
    *,
    bins: int | None = None,
    threshold: float | None = None,
    title: str = "",
) -> "Axes":
    """Draws a histogram of returns with their median.

    Args:
        returns: (runs,): one return per run, such as ``runs.final_returns()``; or several such arrays by name, whose
            histograms share their bins.
        ax: The axes to draw on; None creates a new figure.
        bins: The number of bins; None means the square root of the largest number of runs, at most 40.
        threshold: A return to mark, such as the one at which Gymnasium considers the environment solved.
        title: The title of the axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
    """
    named = returns if isinstance(returns, Mapping) else {"": returns}
    samples = {name: np.asarray(values, dtype=np.float64) for name, values in named.items()}
    ax = axes_or_new(ax)
    count = bins or min(40, math.isqrt(max(map(len, samples.values()))) + 1)
    edges = np.histogram_bin_edges(np.concatenate(list(samples.values())), count).tolist()
    for index, (name, values) in enumerate(samples.items()):
        middle = float(np.median(values))
        label = f"{name or 'runs'}: {len(values)}, median {middle:.4g}"
        ax.hist(values, edges, color=color(index), alpha=0.5, label=label)
        ax.hist(values, edges, color=color(index), histtype="step", linewidth=1.4)
        ax.axvline(middle, color=color(index), linewidth=2)
    if threshold is not None:
        ax.axvline(threshold, color="0.25", linestyle="--", linewidth=1.2, label=f"threshold {threshold:g}")
    ax.locator_params(axis="y", integer=True)
    return finish(ax, "Final return", "Runs", title)
