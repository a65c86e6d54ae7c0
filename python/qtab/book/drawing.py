"""The figures of the book's experiments."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils.extras import missing
from qtab._utils.files import replacing
from qtab.book.experiment import Numbers, Result
from qtab.plots.axes import color, finish, own_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DOTS_PER_INCH = 100
MOST_MARKED = 40
"""A line of more points is drawn without marking them."""


def draw_lines(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the lines, with a band of two standard errors on each side."""
    experiment = result.experiment
    ax = own_axes(ax)
    for index, line in enumerate(line for line in result.lines if line.drawn):
        marker: dict[str, Any] = {"marker": "o", "markersize": 4} if len(line.x) <= MOST_MARKED else {}
        error = np.nan_to_num(line.error)
        low, high = line.mean - 2 * error, line.mean + 2 * error
        ax.fill_between(line.x, low, high, color=color(index), alpha=0.25, linewidth=0)
        ax.plot(line.x, line.mean, color=color(index), linewidth=1.6, label=line.name, **marker)
    if experiment.log_y:
        ax.set_yscale("log")
        for axis in ("set_major_formatter", "set_minor_formatter"):
            getattr(ax.yaxis, axis)("{x:,.0f}")
    if experiment.x_range is not None:
        ax.set_xlim(*experiment.x_range)
    if experiment.y_range is not None:
        ax.set_ylim(*experiment.y_range)
    return finish(ax, experiment.x, experiment.y, _title(result))


def draw_surfaces(result: Result, x: Numbers, y: Numbers, surfaces: Mapping[str, Numbers]) -> "Axes":
    """Draws each surface over position and velocity; returns the last of the axes."""
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise missing(error, "plot") from None
    figure = Figure(figsize=(9, 5.5), layout="constrained")
    figure.suptitle(_title(result))
    positions, velocities = np.meshgrid(x, y, indexing="ij")
    ax: Any = None
    for index, (name, surface) in enumerate(surfaces.items()):
        points = {"rcount": len(x), "ccount": len(y)}
        ax = figure.add_subplot(2, 3, index + 1, projection="3d")
        ax.plot_surface(positions, velocities, surface, cmap="viridis", linewidth=0, **points)
        ax.set_title(f"{name}: up to {surface.max():.0f}", fontsize="medium")
        ax.set(xlabel="position", ylabel="velocity", xticks=(x[0], -0.5, x[-1]), yticks=(y[0], 0, y[-1]))
        ax.tick_params(labelsize="x-small")
        ax.set_box_aspect(None, zoom=0.8)
    axes: Axes = ax
    return axes


def _title(result: Result) -> str:
    experiment = result.experiment
    kind, _, number = experiment.name.partition("-")
    return f"{kind.capitalize()} {number}: {experiment.title}"


def save_plot(result: Result, path: Path) -> None:
    """Draws a result to a file, whole or not at all; its ending gives the format.

    Raises:
        ModuleNotFoundError: without matplotlib; it names the ``pip install``.
        OSError: if the file cannot be written.
    """
    figure: Any = result.plot().figure
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=DOTS_PER_INCH)
