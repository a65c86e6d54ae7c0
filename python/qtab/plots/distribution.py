"""The distribution of the final returns of many runs."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.plots.parts.axes import axes_or_new, check_axes
from qtab.plots.parts.colors import line_style, palette
from qtab.plots.parts.inputs import color_keys, entries, only_threshold
from qtab.plots.parts.labels import finish
from qtab.plots.parts.marks import check_threshold, mark_threshold

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_BINS = 1000
"""The largest number of bins; more would be narrower than a pixel."""
MAX_FILLED = 2
"""The largest number of filled histograms; more are drawn as outlines."""


def distribution(
    returns: Any,
    ax: "Axes | None" = None,
    *,
    bins: int | None = None,
    settings: Sequence[int] | None = None,
    colors: Any = None,
    threshold: float | Literal[False] | None = None,
    title: str = "",
) -> "Axes":
    """Draws a histogram of the final returns of runs, with their median.

    Args:
        returns: A Run, Runs, a Sweep or an array (runs,) with one return per run, such as ``runs.final_returns()``; or
            a mapping of names to any of these. Several histograms share their bins. A sweep has one for each setting;
            of more than eight settings, the eight with the best mean final return, which the legend reports.
        ax: The axes to draw on; None creates a new figure, which a notebook and ``plt.show()`` show.
        bins: The number of bins, at most 1,000; None means the square root of the largest number of runs, at most 40.
        settings: The indices of the settings of a sweep to draw, such as ``[0, 3]``.
        colors: A color, a sequence of colors, or a mapping of names to colors; None chooses.
        threshold: A return to mark by a dotted line. None means that at which Gymnasium considers the environment
            solved, if it is known and not far from the data; False means no line.
        title: The title of the axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, empty data, or returns that are not finite.
    """
    check_axes(ax)
    checks.instance("title", title, str)
    check_threshold(threshold)
    if bins is not None:
        checks.integer("bins", bins, least=1, most=MAX_BINS)
    drawn, note = entries("returns", returns, "final returns", settings)
    edges = _edges([entry.values for entry in drawn], bins)
    ax = axes_or_new(ax)
    hues = palette(color_keys(drawn), ax, None, colors, [entry.label for entry in drawn])
    # Many filled histograms on top of each other would mix their colors.
    fill = 0.5 / math.sqrt(len(drawn)) if len(drawn) <= MAX_FILLED else 0.06
    for index, (entry, hue) in enumerate(zip(drawn, hues, strict=True)):
        middle = float(np.median(entry.values))
        runs = f"{len(entry.values)} run{'' if len(entry.values) == 1 else 's'}, median {middle:.4g}"
        label = f"{entry.label}: {runs}" if entry.label else runs
        ax.hist(entry.values, edges, color=hue, alpha=fill, label=label)
        style: Any = line_style(index)
        ax.hist(entry.values, edges, color=hue, histtype="step", linewidth=1.8, linestyle=style)
        ax.axvline(middle, color=hue, linewidth=2, linestyle=style)
    mark_threshold(ax, threshold, only_threshold(drawn), "x")
    ax.locator_params(axis="y", integer=True)
    return finish(ax, "final return", "runs", title, legend_title=note)


def _edges(samples: list[NDArray[np.float64]], bins: int | None) -> list[float]:
    count = bins or min(40, math.isqrt(max(map(len, samples))) + 1)
    pooled = np.concatenate(samples)
    try:
        edges: list[float] = np.histogram_bin_edges(pooled, count).tolist()
    except ValueError:  # the values are too close to each other for so many bins
        edges = np.histogram_bin_edges(pooled, 1).tolist()
    return edges
