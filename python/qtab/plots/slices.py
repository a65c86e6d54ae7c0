"""The points of a sensitivity plot: for each value of a parameter one setting of a sweep."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from qtab._utils import checks
from qtab.plots.inputs import short
from qtab.sweeps.results import Sweep
from qtab.sweeps.study import to_cell

RESAMPLES = 999
_LARGER_IS_BETTER = ("final_return", "mean_return", "best_return", "terminated_rate")
_STATISTICS = ("mean", "median", "iqm")


@dataclass(frozen=True)
class Point:
    """One setting. With a single run, both bounds are NaN: it has no interval."""

    value: Any
    """The value of the parameter."""
    estimate: float
    low: float
    high: float
    setting: int
    """The index of the setting."""


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
        return Point(value, float(function(runs)), np.nan, np.nan, setting)
    estimate: Any = {"mean": stats.mean, "median": stats.median, "iqm": stats.iqm}[statistic]
    interval = estimate(runs, confidence=confidence, resamples=RESAMPLES)
    return Point(value, interval.estimate, interval.low, interval.high, setting)
