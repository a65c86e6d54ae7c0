"""Performance profiles (Agarwal et al., 2021)."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from qtab.plots.axes import axes_or_new, color, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEVELS = 200


def profile(
    scores: Mapping[str, Any],
    ax: "Axes | None" = None,
    *,
    thresholds: ArrayLike | None = None,
    title: str = "",
) -> "Axes":
    """Draws, for each setting, the share of runs that score above each threshold: higher is better everywhere.

    Args:
        scores: By name (runs,), or (runs, environments), or a mapping of environments to (runs,).
        ax: Where to draw; None makes a figure of its own.
        thresholds: Where to look; None spans all scores.
        title: The picture's.

    Raises:
        ModuleNotFoundError: without matplotlib or scipy; it names the ``pip install``.
        ValueError: for scores of another shape.
    """
    from qtab import stats

    tables = {name: _by_environment(values) for name, values in scores.items()}
    every = np.concatenate([np.asarray(row).ravel() for table in tables.values() for row in table.values()])
    levels = np.linspace(every.min(), every.max(), LEVELS) if thresholds is None else np.asarray(thresholds)
    ax = axes_or_new(ax)
    for index, (name, table) in enumerate(tables.items()):
        ax.step(
            levels, stats.performance_profile(table, levels), where="post", color=color(index), linewidth=2, label=name
        )
    ax.set_ylim(-0.02, 1.02)
    ax.yaxis.set_major_formatter("{x:.0%}")
    return finish(ax, "Score τ", "Share of runs with a score above τ", title)


def _by_environment(values: Any) -> dict[str, Any]:
    if isinstance(values, Mapping):
        return dict(values)
    array = np.asarray(values, dtype=np.float64)
    columns = array[:, np.newaxis] if array.ndim == 1 else array
    return {str(index): column for index, column in enumerate(columns.T)}
