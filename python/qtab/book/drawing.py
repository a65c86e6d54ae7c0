"""Drawing of the figures of the book's experiments."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.plots.axes import axes_or_new, not_shown, save_figure, shown_figure
from qtab.plots.colors import palette
from qtab.plots.labels import finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DOTS_PER_INCH = 100
MAX_MARKERS = 40
"""A line with more points than this is drawn without markers."""


def draw_lines(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the lines of a result with bands of two standard errors on each side, and returns the axes."""
    experiment = result.experiment
    ax = axes_or_new(ax)
    drawn = [line for line in result.lines if line.drawn]
    for line, hue in zip(drawn, palette([line.name for line in drawn], ax), strict=True):
        marker: dict[str, Any] = {"marker": "o", "markersize": 4} if len(line.x) <= MAX_MARKERS else {}
        error = np.nan_to_num(line.error)
        low, high = line.mean - 2 * error, line.mean + 2 * error
        ax.fill_between(line.x, low, high, color=hue, alpha=0.25, linewidth=0)
        ax.plot(line.x, line.mean, color=hue, linewidth=1.6, label=line.name, **marker)
    if experiment.log_y:
        ax.set_yscale("log")
        for axis in ("set_major_formatter", "set_minor_formatter"):
            getattr(ax.yaxis, axis)("{x:,.0f}")
    if experiment.x_range is not None:
        ax.set_xlim(*experiment.x_range)
    if experiment.y_range is not None:
        ax.set_ylim(*experiment.y_range)
    return finish(ax, experiment.x_label, experiment.y_label, experiment.heading)


def draw_surfaces(
    title: str, positions: FloatArray, velocities: FloatArray, surfaces: Mapping[str, FloatArray]
) -> "Axes":
    """Draws each surface, (positions, velocities), in 3D axes of its own in a new figure; returns the last axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
    """
    figure = shown_figure(9, 5.5)
    figure.suptitle(title)
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


def save_plot(result: Result, path: Path) -> None:
    """Draws a result to a file, completely or not at all; the suffix of the path determines the format.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        OSError: if the file cannot be written.
    """
    with not_shown():
        figure: Any = result.plot().figure
    save_figure(figure, path, DOTS_PER_INCH)
