"""Surfaces of the book's figures."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.drawing.titles import title_figure
from qtab.book.runner import FloatArray
from qtab.plots.axes import shown_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_surfaces(
    title: str, positions: FloatArray, velocities: FloatArray, surfaces: Mapping[str, FloatArray]
) -> "Axes":
    """Draws each surface, (positions, velocities), in 3D axes of its own in a new figure; returns the last axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
    """
    figure = shown_figure(9, 5.5)
    title_figure(figure, title)
    x, y = np.meshgrid(positions, velocities, indexing="ij")
    x_ticks, y_ticks = (positions[0], -0.5, positions[-1]), (velocities[0], 0, velocities[-1])
    ax: Any = None
    for index, (name, surface) in enumerate(surfaces.items()):
        points = {"rcount": len(positions), "ccount": len(velocities)}
        ax = figure.add_subplot(2, 3, index + 1, projection="3d")
        ax.plot_surface(x, y, surface, cmap="viridis", linewidth=0, **points)
        ax.set_title(f"{name}: up to {surface.max():.0f}", fontsize="medium")
        ax.set(xlabel="position", ylabel="velocity", xticks=x_ticks, yticks=y_ticks)
        ax.tick_params(labelsize="x-small")
        ax.set_box_aspect(None, zoom=0.8)
    axes: Axes = ax
    return axes
