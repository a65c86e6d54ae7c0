"""The sensitivity of the results of a sweep to a parameter."""

from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.plots.axes import axes_or_new, color, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.sweeps import Sweep

RESAMPLES = 999
LOG_SCALE_RATIO = 50
"""From this ratio of the largest to the smallest value on, the x axis is logarithmic."""


def sensitivity(
    sweep: "Sweep",
    parameter: str,
    ax: "Axes | None" = None,
    *,
    by: str | None = None,
    column: str = "final_return",
    statistic: str = "mean",
    confidence: float = 0.95,
    title: str = "",
) -> "Axes":
    """Draws a column of a sweep's table over one of its parameters, with bootstrap intervals over the runs.

    Args:
        sweep: A result of :func:`qtab.sweep`.
        parameter: The parameter on the x axis. Runs that differ in other parameters than this and ``by`` are pooled.
        ax: The axes to draw on; None creates a new figure.
        by: A second parameter, shown by color.
        column: The column on the y axis.
        statistic: The statistic over the runs: ``"mean"``, ``"median"`` or ``"iqm"``.
        confidence: The coverage probability of the intervals, in [0, 1].
        title: The title of the axes.

    Raises:
        KeyError: if the sweep has no such parameter or column.
        ModuleNotFoundError: without matplotlib or SciPy; the message names the ``pip install``.
    """
    from qtab import stats

    function = {"mean": stats.mean, "median": stats.median, "iqm": stats.iqm}[statistic]
    succeeded = np.array([error is None for error in sweep.columns["error"]], dtype=np.bool_)
    x, y = sweep.columns[parameter], sweep.columns[column]
    groups: list[Any] = [None] if by is None else sorted(set(sweep.columns[by].tolist()))
    ax = axes_or_new(ax)
    is_numeric = x.dtype.kind in "if"
    values = sorted(set(x.tolist()))
    for index, group in enumerate(groups):
        selected = succeeded if by is None else succeeded & (sweep.columns[by] == group)
        present = [value for value in values if (selected & (x == value)).any()]
        points = [function(y[selected & (x == value)], confidence=confidence, resamples=RESAMPLES) for value in present]
        coordinates = present if is_numeric else [values.index(value) for value in present]
        low, high = [point.low for point in points], [point.high for point in points]
        label = None if by is None else f"{by} = {group:g}" if isinstance(group, float) else f"{by} = {group}"
        ax.fill_between(coordinates, low, high, color=color(index), alpha=0.25, linewidth=0)
        ax.plot(coordinates, [point.estimate for point in points], "o-", color=color(index), linewidth=2, label=label)
    if is_numeric and values[0] > 0 and values[-1] / values[0] >= LOG_SCALE_RATIO:
        ax.set_xscale("log")
    if not is_numeric:
        ax.set_xticks(range(len(values)), [str(value) for value in values])
    return finish(ax, parameter, f"{statistic} {column}", title)
