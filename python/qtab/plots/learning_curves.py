"""The learning curves of many runs with confidence intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.shown import counted
from qtab.plots.parts.axes import axes_or_new, check_axes
from qtab.plots.parts.colors import line_style, palette
from qtab.plots.parts.inputs import Entry, color_keys, entries, only_threshold
from qtab.plots.parts.labels import episode_ticks, finish, joined
from qtab.plots.parts.marks import check_optimum, check_threshold, common_block, mark_optimum, mark_threshold
from qtab.results.summary import block_means

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum
    from qtab.stats import Interval

MAX_SINGLE_RUNS = 200
"""The maximum number of single runs that are drawn behind the statistic."""
MAX_CLOUDS = 2
"""With more curves than this, the single runs are left out."""


def learning_curves(
    returns: Any,
    ax: "Axes | None" = None,
    *,
    block: int | None = None,
    statistic: str = "mean",
    confidence: float = 0.95,
    label: str | None = None,
    index: int | None = None,
    settings: Sequence[int] | None = None,
    colors: Any = None,
    optimum: "Optimum | float | None" = None,
    threshold: float | Literal[False] | None = None,
    title: str = "",
) -> "Axes":
    """Draws a statistic over the runs with its interval, in front of the single runs.

    The interval is that of :func:`qtab.stats.curve`. A single run has none, and its means are drawn without one.

    Args:
        returns: A Run, Runs, a Sweep or an array (runs, episodes); or a mapping of names to any of these. A sweep has
            a curve for each setting; of more than eight settings, the eight with the best mean final return, which the
            legend reports.
        ax: The axes to draw on; None creates a new figure, which a notebook and ``plt.show()`` show.
        block: The number of episodes in a block. Each point shows the mean returns of one block. None means 100; more
            for runs of more than 10,000 episodes, and fewer for those of fewer than 2,000.
        statistic: The statistic over the runs: ``"mean"``, ``"median"`` or ``"iqm"``.
        confidence: The coverage probability of the interval, between 0 and 1.
        label: The name of a single curve in the legend; several are named by the mapping or the settings.
        index: The index of the color and of the line's style. Settings on the same axes need different ones. None
            means the algorithm's color if the algorithm is known, else the first.
        settings: The indices of the settings of a sweep to draw, such as ``[0, 3]``.
        colors: A color, a sequence of colors, or a mapping of names to colors; None chooses.
        optimum: A result of :func:`qtab.optimum`, or a return, to mark by a dashed line with its number in the legend.
        threshold: A return to mark by a dotted line. None means that at which Gymnasium considers the environment
            solved, if it is known and not far from the data; False means no line.
        title: The title of the axes.

    Raises:
        ModuleNotFoundError: without matplotlib or SciPy; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, empty data, or returns that are not finite.
    """
    from qtab import stats
    from qtab.stats.bootstrap import as_confidence

    check_axes(ax)
    checks.instance("title", title, str)
    check_optimum(optimum)
    check_threshold(threshold)
    checks.choice("statistic", statistic, ("mean", "median", "iqm"))
    if index is not None:
        checks.integer("index", index, least=0)
    drawn, note = entries("returns", returns, "curves", settings)
    confidence = as_confidence(confidence)
    if label is not None:
        checks.instance("label", label, str)
        if isinstance(returns, Mapping) or len(drawn) > 1:
            raise ValueError(f"label must be None where returns has names or several settings, got {label!r}")
        drawn = [replace(drawn[0], label=label)]
    block = common_block(block, [entry.values.shape[1] * entry.unit for entry in drawn], [e.unit for e in drawn])
    # The numbers come before the figure, so that an error leaves no empty figure.
    means = [block_means(entry.values, block // entry.unit) for entry in drawn]
    points = [
        stats.curve(runs, block=1, statistic=statistic, confidence=confidence) if len(runs) > 1 else None
        for runs in means
    ]
    ax = axes_or_new(ax)
    hues = palette(color_keys(drawn), ax, index, colors, [entry.label for entry in drawn])
    names, heading = _names(drawn, statistic, f"{100 * confidence:.4g}%")
    for position, (name, runs, curve, hue) in enumerate(zip(names, means, points, hues, strict=True)):
        x = block * (np.arange(runs.shape[1]) + 1)
        if curve is not None and len(drawn) <= MAX_CLOUDS:
            faint: dict[str, Any] = {"color": hue, "linewidth": 0.6, "alpha": max(0.04, min(0.4, 8 / len(runs)))}
            ax.plot(x, runs[:MAX_SINGLE_RUNS].T, rasterized=True, zorder=1, **faint)
        _draw_curve(ax, x, runs, curve, hue, name, line_style((index or 0) + position))
    mark_optimum(ax, optimum)
    mark_threshold(ax, threshold, only_threshold(drawn))
    episode_ticks(ax)
    return finish(
        ax, "episode", f"return, mean of {counted(block, 'episode')}", title, legend_title=joined(note, heading)
    )


def _draw_curve(
    ax: "Axes",
    x: NDArray[np.int64],
    runs: NDArray[np.float64],
    curve: "list[Interval] | None",
    hue: Any,
    name: str,
    style: Any,
) -> None:
    """Draws a statistic with its interval, or the means of a single run."""
    y: Any = runs[0]
    if curve is not None:
        y = [point.estimate for point in curve]
        low, high = [point.low for point in curve], [point.high for point in curve]
        ax.fill_between(x, low, high, color=hue, alpha=0.3, linewidth=0, zorder=2)
    marker: dict[str, Any] = {"marker": "o", "markersize": 4} if len(x) == 1 else {}
    ax.plot(x, y, color=hue, linewidth=2.2, linestyle=style, label=name, zorder=3, **marker)


def _names(drawn: list[Entry], statistic: str, confidence: str) -> tuple[list[str], str]:
    """Returns the names of the curves in the legend, and its title with the text that applies to all of them."""
    counts = [len(entry.values) for entry in drawn]
    if len(drawn) == 1:
        shown = "1 run" if counts[0] == 1 else f"{statistic} of {counts[0]:,} runs, {confidence} interval"
        return [joined(drawn[0].label, shown, separator=": ")], ""
    if max(counts) == 1:
        return [entry.label for entry in drawn], "1 run each"
    if len(set(counts)) == 1:
        return [entry.label for entry in drawn], f"{statistic} of {counts[0]:,} runs, {confidence} intervals"
    names = [f"{entry.label}: {counted(count, 'run')}" for entry, count in zip(drawn, counts, strict=True)]
    return names, f"{statistic} of the runs, {confidence} intervals"
