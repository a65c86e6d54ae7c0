"""Performance profiles (Agarwal et al., 2021)."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from qtab.plots.axes import axes_or_new, color, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEVELS = 200
"""The number of thresholds if none are given."""


def profile(
    scores: Mapping[str, Any],
    ax: "Axes | None" = None,
    *,
    thresholds: ArrayLike | None = None,
    title: str = "",
) -> "Axes":
    """Draws, for each setting, the proportion of runs that score above each threshold. Higher curves are better.

    Args:
        scores: For each setting its scores: (runs,), (runs, environments), or a mapping of environments to (runs,).
        ax: The axes to draw on; None creates a new figure.
        thresholds: (thresholds,) float; None spans all scores.
        title: The title of the axes.

    Raises:
        ModuleNotFoundError: without matplotlib or SciPy; the message names the ``pip install``.
        ValueError: for scores of another shape.
    """
    from qtab import stats

    settings = {name: _by_environment(values) for name, values in scores.items()}
    pooled = np.concatenate([np.ravel(runs) for environments in settings.values() for runs in environments.values()])
    levels = np.linspace(pooled.min(), pooled.max(), LEVELS) if thresholds is None else np.asarray(thresholds)
    ax = axes_or_new(ax)
    for index, (name, environments) in enumerate(settings.items()):
        proportions = stats.performance_profile(environments, levels)
        ax.step(levels, proportions, where="post", color=color(index), linewidth=2, label=name)
    ax.set_ylim(-0.02, 1.02)
    ax.yaxis.set_major_formatter("{x:.0%}")
    return finish(ax, "Score τ", "Proportion of runs with a score above τ", title)


def _by_environment(values: Any) -> dict[str, Any]:
    if isinstance(values, Mapping):
        return dict(values)
    array = np.asarray(values, dtype=np.float64)
    columns = array[:, np.newaxis] if array.ndim == 1 else array
    return {str(index): column for index, column in enumerate(columns.T)}
