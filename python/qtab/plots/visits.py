"""A picture of the visits of a run."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from qtab.plots.arrangements import Raster
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.parts.panels import arranged, draw_heat_maps
from qtab.plots.parts.subject import Subject
from qtab.results.run import Run
from qtab.results.time_steps import over_all_steps

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize


def visits(
    run: Run | Sequence[Run],
    ax: "Axes | None" = None,
    *,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    title: str | None = None,
) -> "Axes":
    """Draws the number of visits of each state in training, on a logarithmic scale. Grey states were never visited.

    With tile coding the number at a point is the mean over the tiles that it lies in, with ``time_aware=True`` the sum
    over the steps of an episode.

    Args:
        run: A run trained with ``visits=True``; a sequence of them makes panels with one scale of colors.
        ax: The axes to draw on; None creates a new figure. A sequence needs None.
        at: For observations of more than two components, the values of those that are not axes; see
            :func:`qtab.plots.values`.
        layout: A map for numbered states; see :func:`qtab.plots.values`.
        title: The title; None names the environment, the algorithm and the seed.

    Returns:
        The axes; of several panels, those of the first.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for a run without visits, or an argument that does not fit the environment.
    """
    shown = [over_all_steps(one) for one in run] if isinstance(run, list | tuple) else over_all_steps(run)
    panels = arranged(shown, at, layout, title)
    counts = [_counts(subject, raster) for subject, raster in panels]
    return draw_heat_maps(panels, counts, ax, norm=_norm, label="visits", title=title, text=_short)


def _norm(grids: Sequence[NDArray[np.float64]]) -> "Normalize":
    from matplotlib.colors import LogNorm

    return LogNorm(1, max(float(grid[np.isfinite(grid)].max(initial=2.0)) for grid in grids))


def _counts(subject: Subject, raster: Raster) -> NDArray[np.float64]:
    """Returns (ny, nx): the visits of each state; NaN where there are none.

    Raises:
        TypeError: for Runs and for an optimum.
        ValueError: for a run that did not count them.
    """
    if not isinstance(subject.source, Run):
        raise TypeError(f"run must be a Run, whose visits can be counted, got {subject.source!r}")
    counted = subject.source.visits
    if counted is None:
        raise ValueError("run must have visits: qtab.train(..., visits=True) counts them")
    by_row = counted.reshape(-1, counted.shape[-1]).sum(axis=-1)
    counts = np.where((raster.rows < 0).any(axis=-1), 0.0, by_row[raster.rows].mean(axis=-1))
    return np.where(counts > 0, np.maximum(counts, 1.0), np.nan)


def _short(count: float) -> str:
    for limit, unit in ((1e6, "M"), (1e3, "k")):
        if count >= limit:
            return f"{count / limit:.2g}{unit}" if count < 100 * limit else f"{count / limit:.0f}{unit}"
    return f"{count:.0f}"
