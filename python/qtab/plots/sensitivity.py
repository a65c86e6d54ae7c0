"""The sensitivity of the results of a sweep to a parameter."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from qtab._utils import checks
from qtab.plots.parts.axes import axes_or_new, check_axes
from qtab.plots.parts.colors import line_style, palette
from qtab.plots.parts.inputs import short
from qtab.plots.parts.labels import category_ticks, finish, joined
from qtab.plots.parts.marks import check_optimum, check_threshold, mark_optimum, mark_threshold
from qtab.sweeps.environments import sweep_threshold
from qtab.sweeps.results import Sweep
from qtab.sweeps.study import to_cell

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

RESAMPLES = 999
_LARGER_IS_BETTER = ("final_return", "mean_return", "best_return", "terminated_rate")
_STATISTICS = ("mean", "median", "iqm")
_WORDS = {"mean": "mean", "median": "median", "iqm": "interquartile mean of the"}
"""The words for each statistic on the y axis."""


@dataclass(frozen=True)
class Point:
    """One setting. With a single run, both bounds are NaN: it has no interval."""

    value: Any
    """The value of the parameter."""
    estimate: float
    low: float
    high: float


def slice_of(
    sweep: Sweep,
    parameter: str,
    by: str | None,
    fixed: Mapping[str, Any] | None,
    column: str,
    statistic: str,
    confidence: float,
) -> tuple[list[tuple[Any, list[Point]]], str]:
    """Returns for each value of ``by`` the points, sorted, and a note on the other parameters.

    See :func:`qtab.plots.sensitivity` for the arguments and the errors.
    """
    names = list(sweep.settings[0])
    checks.choice("parameter", parameter, names)
    if by is not None and checks.choice("by", by, names) == parameter:
        raise ValueError(f"by must be another parameter than {parameter!r}")
    columns = [name for name, cells in sweep.columns.items() if cells.dtype.kind in "iuf" and name != "setting"]
    checks.choice("column", column, columns)
    checks.choice("statistic", statistic, _STATISTICS)
    fixed = _fixed(sweep, fixed, {parameter, by})
    settings = [
        setting
        for setting, values in enumerate(sweep.settings)
        if len(sweep.values("seed", setting)) and all(_key(values[name]) == _key(fixed[name]) for name in fixed)
    ]
    if not settings:
        raise ValueError(f"sweep must have at least one run that succeeded, got {sweep!r}")
    groups = [None] if by is None else _ordered(sweep.settings[setting][by] for setting in settings)
    lines = []
    for group in groups:
        points = []
        for value in _ordered(sweep.settings[setting][parameter] for setting in settings):
            candidates = [
                setting
                for setting in settings
                if _key(sweep.settings[setting][parameter]) == _key(value)
                and (by is None or _key(sweep.settings[setting][by]) == _key(group))
            ]
            if candidates:
                best = max(candidates, key=lambda setting: _merit(sweep, setting, column, statistic))
                points.append(_point(sweep, best, to_cell(value), column, statistic, confidence))
        lines.append((to_cell(group), points))
    varied = [name for name in names if name not in {parameter, by, *fixed} and _varies(sweep, settings, name)]
    notes = [f"{name} = {short(value)}" for name, value in fixed.items()]
    notes += [f"best {', '.join(varied)} for each point"] if varied else []
    return lines, ", ".join(notes)


def _fixed(sweep: Sweep, fixed: Any, drawn: set[str | None]) -> dict[str, Any]:
    """Returns the argument ``fixed``, checked."""
    if fixed is None:
        return {}
    if not isinstance(fixed, Mapping):
        raise TypeError(f"fixed must map names of parameters to values, got {fixed!r}")
    others = [name for name in sweep.settings[0] if name not in drawn]
    for name, value in fixed.items():
        if not others:
            raise ValueError(f"fixed must be empty where the sweep has no other parameters, got {fixed!r}")
        checks.choice("a name in fixed", name, others)
        known = _ordered(setting[name] for setting in sweep.settings)
        if _key(value) not in map(_key, known):
            raise ValueError(f"fixed[{name!r}] must be one of {', '.join(map(short, known))}, got {value!r}")
    return dict(fixed)


def _key(value: Any) -> Any:
    """Returns a key that equal values of a setting share: 1 and 1.0 are equal, 1 and True are not."""
    cell = to_cell(value)
    return isinstance(cell, bool), cell


def _ordered(values: Iterable[Any]) -> list[Any]:
    """Returns the different values: numbers by size, all others in their order."""
    different = list({_key(value): value for value in values}.values())
    is_numeric = all(isinstance(to_cell(value), int | float) and not isinstance(value, bool) for value in different)
    return sorted(different) if is_numeric else different


def _varies(sweep: Sweep, settings: list[int], name: str) -> bool:
    return len({_key(sweep.settings[setting][name]) for setting in settings}) > 1


def _merit(sweep: Sweep, setting: int, column: str, statistic: str) -> float:
    """Returns the number that ranks several settings."""
    if column in _LARGER_IS_BETTER:
        return _point(sweep, setting, None, column, statistic, None).estimate
    return float(sweep.values("final_return", setting).mean())


def _point(sweep: Sweep, setting: int, value: Any, column: str, statistic: str, confidence: float | None) -> Point:
    """Returns the statistic of a setting; without ``confidence``, or with a single run, without an interval."""
    from qtab import stats
    from qtab.stats.intervals import interquartile_mean

    runs = sweep.values(column, setting)
    if confidence is None or len(runs) < 2:
        function: Any = {"mean": np.mean, "median": np.median, "iqm": interquartile_mean}[statistic]
        return Point(value, float(function(runs)), np.nan, np.nan)
    estimate: Any = {"mean": stats.mean, "median": stats.median, "iqm": stats.iqm}[statistic]
    interval = estimate(runs, confidence=confidence, resamples=RESAMPLES)
    return Point(value, interval.estimate, interval.low, interval.high)


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
    measured = f"{_WORDS[statistic]} {column.replace('_', ' ')}"
    return finish(ax, parameter, measured, title, legend_title=joined(note, shown))


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
