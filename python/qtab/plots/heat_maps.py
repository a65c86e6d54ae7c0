"""Panels of numbers as colors, with one scale and one color bar."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from qtab.plots.arrangements import Raster
from qtab.plots.colors import SEQUENTIAL
from qtab.plots.panels import axes_for, color_bar, draw_cells, finish_panel, shade_unknown, write_numbers
from qtab.plots.subject import Subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize


def draw_heat_maps(
    panels: Sequence[tuple[Subject, Raster]],
    numbers: Sequence[NDArray[np.float64]],
    ax: "Axes | None",
    *,
    norm: "Callable[[NDArray[np.float64]], Normalize]",
    label: str,
    title: str | None,
    text: Callable[[float], str] | None,
) -> "Axes":
    """Draws a panel for each subject.

    Args:
        panels: What to draw, and where each panel shows which state.
        numbers: (ny, nx) for each panel; NaN where a state has no number.
        ax: The axes to draw on; None creates a new figure.
        norm: Returns the scale of the colors for all finite numbers, (n,).
        label: The label of the color bar.
        title: The title of each panel; None names its subject.
        text: Returns how a number is written into its cell, where cells have room; None writes none.

    Returns:
        The axes, of several panels the first.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if one axes is given for several panels.
    """
    axes = axes_for([raster for _, raster in panels], ax)
    scale = norm(np.concatenate([grid[np.isfinite(grid)] for grid in numbers]))
    for (subject, raster), grid, panel in zip(panels, numbers, axes, strict=True):
        shade_unknown(panel, raster, grid)
        image = draw_cells(panel, raster, grid, SEQUENTIAL, scale)
        if text is not None and raster.has_numbers:
            write_numbers(panel, raster, grid, image, text)
        finish_panel(panel, raster, subject.name if title is None else title)
    color_bar(axes, panels[0][1], image, label)
    return axes[0]
