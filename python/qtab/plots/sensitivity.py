"""The sensitivity of the results of a sweep to a parameter."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from qtab._utils import checks
from qtab.plots.axes import axes_or_new, check_axes
from qtab.plots.colors import line_style, palette
from qtab.plots.inputs import short
from qtab.plots.labels import category_ticks, finish, joined
from qtab.plots.marks import check_optimum, check_threshold, mark_optimum, mark_threshold
from qtab.plots.slices import Point, slice_of
from qtab.sweeps.environments import sweep_threshold
from qtab.sweeps.results import Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

LOG_SCALE_RATIO = 50
"""The x axis is logarithmic if the largest value is at least this many times the smallest."""


def sensitivity(
    sweep: Sweep,
    parameter: str,
    ax: "Axes | None" = None,
    *,
    by: str | None = None,
    fixed: Mapping[str, Any] | None = None,
    column: str = "final_return",
    statistic: str = "mean",
    confidence: float = 0.95,
    colors: Any = None,
    optimum: "Optimum | float | None" = None,
    threshold: float | Literal[False] | None = None,
    title: str = "",
) -> "Axes":
    """Draws a column of a sweep's table over one of its parameters, with intervals over the seeds.

    Each point is one setting, and its interval is over the runs of that setting: runs that differ in another parameter
    are never pooled. The other parameters have the values in ``fixed``; those missing from it have, for each point, the
    values with the best statistic, as in the parameter studies of Sutton & Barto. The legend names these parameters.
    The best of several settings with the same seeds looks better than it is: train it with fresh seeds before you
    report its return.

    Args:
        sweep: A result of :func:`qtab.sweep`.
        parameter: The parameter on the x axis.
        ax: The axes to draw on; None creates a new figure, which a notebook and ``plt.show()`` show.
        by: A second parameter, with one line for each of its values.
        fixed: Values of other parameters, such as ``{"discount": 0.9}``.
        column: The column on the y axis. The best is the largest if it is a return or ``"terminated_rate"``; for other
            columns the best settings are those with the largest mean ``"final_return"``.
        statistic: The statistic over the runs: ``"mean"``, ``"median"`` or ``"iqm"``.
        confidence: The coverage probability of the intervals, between 0 and 1. A setting with one run has none.
        colors: A color, a sequence of colors, or a mapping of names to colors; None chooses.
        optimum: A result of :func:`qtab.optimum`, or a return, to mark by a dashed line with its number in the legend.
        threshold: A return to mark by a dotted line. None means that at which Gymnasium considers the environment
            solved, if it is not far from the data and the column is ``"final_return"``; False means no line.
        title: The title of the axes.

    Raises:
        ModuleNotFoundError: without matplotlib or SciPy; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: if the sweep has no such parameter, column or value, or no run that succeeded.
    """
    from qtab.stats.bootstrap import as_confidence

    checks.instance("sweep", sweep, Sweep)
    check_axes(ax)
    checks.instance("title", title, str)
    confidence = as_confidence(confidence)
    check_optimum(optimum)
    check_threshold(threshold)
    lines, note = slice_of(sweep, parameter, by, fixed, column, statistic, confidence)
    ax = axes_or_new(ax)
    keys = [key for key, _ in lines]
    labels = ["" if by is None else f"{by} = {short(key)}" for key in keys]
    values = list(dict.fromkeys(point.value for _, points in lines for point in points))
    numbers = [value for value in values if isinstance(value, int | float) and not isinstance(value, bool)]
    is_numeric = len(numbers) == len(values)
    if by is None and not is_numeric:  # one color for each category, as for each algorithm elsewhere
        for point, hue in zip(lines[0][1], palette(values, ax, None, colors), strict=True):
            _draw_line(ax, [point], values, hue, "", "none")
    else:
        hues = palette(keys, ax, None, colors, labels)
        for index, ((_, points), label, hue) in enumerate(zip(lines, labels, hues, strict=True)):
            _draw_line(ax, points, None if is_numeric else values, hue, label, line_style(index))
    if is_numeric and min(numbers) > 0 and max(numbers) / min(numbers) >= LOG_SCALE_RATIO:
        ax.set_xscale("log")
    if not is_numeric:
        category_ticks(ax, [short(value) for value in values])
    mark_optimum(ax, optimum)
    mark_threshold(ax, threshold, sweep_threshold(sweep) if column == "final_return" else None)
    shown = f"{100 * confidence:.4g}% intervals over seeds"
    return finish(ax, parameter, f"{statistic} {column}", title, legend_title=joined(note, shown))


def _draw_line(ax: "Axes", points: list[Point], categories: list[Any] | None, hue: Any, label: str, line: Any) -> None:
    """Draws the points of one line with a band, or with error bars and no line for categories and single points."""
    x = [point.value if categories is None else categories.index(point.value) for point in points]
    y = [point.estimate for point in points]
    low, high = np.array([point.low for point in points]), np.array([point.high for point in points])
    if categories is None and len(points) > 1:
        ax.fill_between(x, low, high, color=hue, alpha=0.3, linewidth=0)
        ax.plot(x, y, marker="o", color=hue, linewidth=2, linestyle=line, label=label or None)
    else:
        style: dict[str, Any] = {"linestyle": "none", "capsize": 4, "linewidth": 2}
        ax.errorbar(x, y, [np.subtract(y, low), np.subtract(high, y)], fmt="o", color=hue, label=label, **style)
