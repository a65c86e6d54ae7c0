"""Pictures of numbers as colors."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.plots.arrangements import Raster
from qtab.plots.colors import SEQUENTIAL
from qtab.plots.panels import axes_for, color_bar, draw_cells, finish_panel, shade_unknown, write_numbers
from qtab.plots.subject import Subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize

Text = Callable[[float], str]
"""Returns the text of a number in its cell."""


def draw_heat_maps(
    panels: Sequence[tuple[Subject, Raster]],
    grids: Sequence[NDArray[np.float64]],
    ax: "Axes | None",
    *,
    norm: "Callable[[Sequence[NDArray[np.float64]]], Normalize]",
    label: str,
    title: str | None,
    text: Text | None,
    one_scale: bool = True,
) -> "Axes":
    """Draws a panel for each subject, with one scale of colors and one color bar, or one for each.

    Args:
        panels: The subject and the raster of each panel.
        grids: (ny, nx) for each panel: the numbers; NaN where a state has none.
        ax: The axes to draw on; None creates a new figure.
        norm: Returns the scale of the colors for the grids.
        label: The label of the color bar.
        title: The title of each panel; None names its subject.
        text: Writes the numbers into their cells, if there is room; None writes none.
        one_scale: Whether all panels have the same scale.

    Returns:
        The axes; of several panels, those of the first.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if one axes is given for several panels.
    """
    axes = axes_for([raster for _, raster in panels], ax)  # without matplotlib, this names the extra
    scales = [norm(grids)] * len(grids) if one_scale else [norm([grid]) for grid in grids]
    for (subject, raster), grid, panel, scale in zip(panels, grids, axes, scales, strict=True):
        image = draw_heat_map(panel, raster, grid, scale, subject.name if title is None else title, text)
        if not one_scale:
            color_bar([panel], raster, image, label)
    if one_scale:
        color_bar(axes, panels[0][1], image, label)
    return axes[0]


def draw_heat_map(
    ax: "Axes", raster: Raster, grid: NDArray[np.float64], norm: "Normalize", title: str, text: Text | None
) -> Any:
    """Draws (ny, nx) numbers, the grey of states that have none, and the title; returns the image for a color bar."""
    shade_unknown(ax, raster, grid)
    image = draw_cells(ax, raster, grid, SEQUENTIAL, norm)
    if text is not None and raster.has_numbers:
        write_numbers(ax, raster, grid, image, text)
    finish_panel(ax, raster, title)
    return image
