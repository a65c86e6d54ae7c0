"""A picture of where a run has been."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from qtab.plots.arrangements import Raster, arrange
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.panels import (
    axes_for,
    check_same_environment,
    color_bar,
    draw_cells,
    finish_panel,
    shade_unknown,
    subjects_of,
    write_numbers,
)
from qtab.plots.subject import Subject
from qtab.results.run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def visits(
    run: Run | Sequence[Run],
    ax: "Axes | None" = None,
    *,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    title: str | None = None,
) -> "Axes":
    """Draws how often training visited each state, on a logarithmic scale. Grey states were never visited.

    With tile coding the number at a point is the mean over the tiles that it lies in.

    Args:
        run: A run trained with ``visits=True``; a sequence of them makes panels with one scale of colors.
        ax: The axes to draw on; None creates a new figure. A sequence needs None.
        at: For observations of more than two components, the values of those that are not axes; see
            :func:`qtab.plots.values`.
        layout: A map for numbered states; see :func:`qtab.plots.values`.
        title: The title; None names the environment, the algorithm and the seed.

    Returns:
        The axes, of several panels the first.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for a run without visits, or an argument that does not fit the environment.
    """
    subjects = subjects_of("run", run)
    for subject in subjects:
        _require_visits(subject)
    check_same_environment(subjects, "run")
    rasters = [arrange(subject, at, layout) for subject in subjects]
    shown = [_counts(subject, raster) for subject, raster in zip(subjects, rasters, strict=True)]
    axes = axes_for(rasters, ax)
    from matplotlib.colors import LogNorm  # after the axes: the message without matplotlib is theirs

    most = max([2.0, *(float(grid[np.isfinite(grid)].max(initial=2.0)) for grid in shown)])
    norm = LogNorm(1, most)
    for subject, raster, grid, panel in zip(subjects, rasters, shown, axes, strict=True):
        shade_unknown(panel, raster, grid)
        image = draw_cells(panel, raster, grid, "viridis", norm)
        if raster.has_numbers:
            write_numbers(panel, raster, grid, image, _short)
        finish_panel(panel, raster, subject.name if title is None else title)
    color_bar(axes, rasters[0], image, "visits")
    return axes[0]


def _require_visits(subject: Subject) -> None:
    if not isinstance(subject.source, Run):
        raise TypeError(f"run must be a Run, whose visits can be counted, got {subject.source!r}")
    if subject.source.visits is None:
        raise ValueError("run must have visits: qtab.train(..., visits=True) counts them")


def _counts(subject: Subject, raster: Raster) -> NDArray[np.float64]:
    """Returns (ny, nx): the visits of each state; NaN where there are none."""
    counted = subject.source.visits if isinstance(subject.source, Run) else None
    if counted is None:
        return np.full(raster.rows.shape[:2], np.nan)
    by_row = counted.reshape(-1, counted.shape[-1]).sum(axis=-1)
    counts = np.where((raster.rows < 0).any(axis=-1), 0.0, by_row[raster.rows].mean(axis=-1))
    return np.where(counts > 0, np.maximum(counts, 1.0), np.nan)


def _short(count: float) -> str:
    for limit, unit in ((1e6, "M"), (1e3, "k")):
        if count >= limit:
            return f"{count / limit:.2g}{unit}" if count < 100 * limit else f"{count / limit:.0f}{unit}"
    return f"{count:.0f}"
