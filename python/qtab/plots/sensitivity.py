"""How much a setting matters."""

from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.plots.axes import color, finish, own_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.sweeps import Sweep

RESAMPLES = 999


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
    """Draws a column of a sweep's table over one of its parameters, with bootstrap intervals over the seeds.

    Args:
        sweep: What :func:`qtab.sweep` returned.
        parameter: The name on the x axis; what else was varied, but for ``by``, is pooled.
        ax: Where to draw; None makes a figure of its own.
        by: A second parameter, shown as colour.
        column: The column on the y axis.
        statistic: ``"mean"``, ``"median"`` or ``"iqm"`` over the runs.
        confidence: Of the intervals.
        title: The picture's.

    Raises:
        KeyError: if the sweep has no such parameter or column.
        ModuleNotFoundError: without matplotlib or scipy; it names the ``pip install``.
    """
    from qtab import stats

    function = {"mean": stats.mean, "median": stats.median, "iqm": stats.iqm}[statistic]
    whole = np.array([error is None for error in sweep.columns["error"]], dtype=np.bool_)
    x, y = sweep.columns[parameter], sweep.columns[column]
    groups: list[Any] = [None] if by is None else sorted(set(sweep.columns[by].tolist()))
    ax = own_axes(ax)
    numbers = x.dtype.kind in "if"
    values = sorted(set(x.tolist()))
    for index, group in enumerate(groups):
        chosen = whole if by is None else whole & (sweep.columns[by] == group)
        shown = [value for value in values if (chosen & (x == value)).any()]
        points = [function(y[chosen & (x == value)], confidence=confidence, resamples=RESAMPLES) for value in shown]
        places = shown if numbers else [values.index(value) for value in shown]
        low, high = [point.low for point in points], [point.high for point in points]
        label = None if by is None else f"{by} = {group:g}" if isinstance(group, float) else f"{by} = {group}"
        ax.fill_between(places, low, high, color=color(index), alpha=0.25, linewidth=0)
        ax.plot(places, [point.estimate for point in points], "o-", color=color(index), linewidth=2, label=label)
    if numbers and values[0] > 0 and values[-1] / values[0] >= 50:  # spread over decades
        ax.set_xscale("log")
    if not numbers:
        ax.set_xticks(range(len(values)), [str(value) for value in values])
    return finish(ax, parameter, f"{statistic} {column}", title)
