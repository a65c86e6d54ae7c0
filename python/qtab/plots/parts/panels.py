"""Parts of the pictures of tables: panels with one scale of colors, numbers as colors, light and dark styles."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.envs.registry import bare_id
from qtab.plots.arrangements import Raster, arrange
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.arrangements.raster import DARK, LIGHT
from qtab.plots.parts.axes import axes_or_new, shown_figure
from qtab.plots.parts.colors import SEQUENTIAL, brightness, is_dark
from qtab.plots.parts.labels import check_title, fitted
from qtab.plots.parts.subject import Drawable, Subject, subject_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize

MAX_PANELS_IN_A_ROW = 3
WIDE = 2.0
"""A picture of several panels has them in one column if they are this many times as wide as high."""
LEAST_LABEL = 60.0
"""The label of a color bar has lines of this length, in points, also beside a lower picture."""


def arranged(
    run: Drawable | Sequence[Drawable],
    at: Mapping[str, float] | None,
    layout: Layout | None,
    title: str | None,
    step: int = 0,
) -> list[tuple[Subject, Raster]]:
    """Returns the subject and the raster of each panel of a picture.

    Args:
        run: The argument ``run`` of a plot: a run, Runs or an optimum, or a sequence of them.
        at: The components of the observation that are held fixed.
        layout: The map of an environment with numbered states; None takes the known one.
        title: The title of the picture, which is only checked.
        step: The step of the episode to show, for runs with ``time_aware=True``.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an empty sequence, different environments, runs without tables, or an argument that does not
            fit the environment.
    """
    check_title(title)
    if not isinstance(run, list | tuple):
        subjects = [subject_of("run", run, step)]
    elif run:
        subjects = [subject_of(f"run[{index}]", one, step) for index, one in enumerate(run)]
    else:
        raise ValueError(f"run must hold at least one run, got an empty {type(run).__name__}")
    names = {bare_id(subject.env) for subject in subjects}
    if len(names) > 1:
        raise ValueError(f"run must hold runs of one environment, got {', '.join(sorted(map(repr, names)))}")
    return [(subject, arrange(subject, at, layout)) for subject in subjects]


def axes_for(rasters: Sequence[Raster], ax: "Axes | None") -> "list[Axes]":
    """Returns the axes of the panels: the given one, or those of a new figure.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if one axes is given for several panels.
    """
    if len(rasters) == 1:
        if ax is not None:
            return [axes_or_new(ax)]
        return [shown_figure(*rasters[0].size).subplots()]
    if ax is not None:
        raise ValueError(f"ax must be None for {len(rasters)} runs, which need a panel each")
    width, height = (max(raster.size[side] for raster in rasters) for side in (0, 1))
    # Wide maps lie below each other, where their cells stay large.
    columns = 1 if width > WIDE * height else min(len(rasters), MAX_PANELS_IN_A_ROW)
    lines = -(-len(rasters) // columns)
    grid: Any = shown_figure(0.85 * width * columns, 0.95 * height * lines).subplots(lines, columns, squeeze=False)
    for unused in grid.ravel()[len(rasters) :]:
        unused.set_axis_off()
    return list(grid.ravel()[: len(rasters)])


def ink(ax: "Axes") -> str:
    """Returns the color of letters and lines on the background."""
    return LIGHT if is_dark(ax) else DARK


def shade_unknown(ax: "Axes", raster: Raster, values: NDArray[Any]) -> None:
    """Fills the states without a value, which have NaN or negative indices, with grey."""
    from matplotlib.colors import ListedColormap

    unknown = raster.has_state & ~(values >= 0 if values.dtype.kind == "i" else np.isfinite(values))
    if unknown.any():
        grey = ListedColormap(["#444444" if is_dark(ax) else "#d5d5d5"])
        draw_cells(ax, raster, np.where(unknown, 0.0, np.nan), grey)


def draw_cells(
    ax: "Axes", raster: Raster, values: NDArray[np.float64], cmap: Any, norm: "Normalize | None" = None
) -> Any:
    """Draws (ny, nx) values in colors; NaN stays transparent. Returns the image for a color bar."""
    shown = np.ma.masked_invalid(values)
    # Without rasterization, a vector picture would hold every point as a polygon.
    return ax.pcolormesh(raster.x_edges, raster.y_edges, shown, cmap=cmap, norm=norm, rasterized=True)


def write_numbers(
    ax: "Axes", raster: Raster, values: NDArray[np.float64], image: Any, text: "Text", size: str | float | None = None
) -> None:
    """Writes the text of each cell's number, which fits the cell, in a color that is readable on that of the cell."""
    xs, ys = (middles.tolist() for middles in raster.centers)
    size = cell_font_size(ax, raster) if size is None else size
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            color = "#ffffff" if brightness(image.to_rgba(value)) < 0.5 else "#101010"
            ax.text(xs[column], ys[row], text(value), color=color, fontsize=size, ha="center", va="center", zorder=7)


def finish_panel(ax: "Axes", raster: Raster, title: str, note: str = "") -> None:
    """Draws the marks of the arrangement, the title and the note."""
    ax.set_title(title, loc="left", fontsize="medium", fontweight="bold")
    if note := note or raster.note:
        ax.text(1.0, 1.015, note, transform=ax.transAxes, ha="right", va="bottom", fontsize="x-small", alpha=0.8)
        ax.set_title(title + "\n", loc="left", fontsize="medium", fontweight="bold")
    raster.frame(ax, ink(ax))


def color_bar(axes: "Sequence[Axes]", raster: Raster, image: Any, label: str, extend: str = "neither") -> Any:
    """Draws a color bar as high as a panel beside it, or one beside all panels."""
    figure: Any = axes[0].figure
    if len(axes) == 1:
        # Inset: the bar would otherwise be higher than a map, whose cells are square.
        place: dict[str, Any] = {"cax": axes[0].inset_axes((raster.bar_at, 0.0, 0.03, 1.0))}
    else:
        place = {"ax": list(axes), "pad": 0.02, "fraction": 0.05}
    bar = figure.colorbar(image, extend=extend, **place)
    # The label of a low picture is broken into lines.
    axes[0].apply_aspect()
    height = sum(ax.get_window_extent().height for ax in axes) * 72 / figure.dpi
    bar.set_label(fitted(label, max(height, LEAST_LABEL), float(bar.ax.yaxis.label.get_fontsize())))
    bar.outline.set_visible(False)
    return bar


def cell_font_size(ax: "Axes", raster: Raster) -> float:
    """Returns the font size, in points, with which a number fits into a cell."""
    figure: Any = ax.figure
    width = ax.get_position().width * figure.get_figwidth() * 72 / len(raster.x_edges)
    height = ax.get_position().height * figure.get_figheight() * 72 / len(raster.y_edges)
    return max(4.0, min(11.0, float(width) / 3.3, float(height) / 1.6))


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
