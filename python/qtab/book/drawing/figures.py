"""Figures of several axes with one title, and figures in files."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from qtab.book.result import Result
from qtab.plots.parts.axes import not_shown, save_figure, shown_figure
from qtab.plots.parts.labels import fitted

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEFT = 0.02
"""The x position of the title, as a fraction of the width."""
DOTS_PER_INCH = 100


def figure_of_several(result: Result, ax: "Axes | None", width: float, height: float) -> "Figure":
    """Returns a new figure for a result that has several axes, with the title on the left, in bold.

    Args:
        result: The result to draw.
        ax: Must be None.
        width: The width in inches.
        height: The height in inches.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if ``ax`` is not None.
    """
    if ax is not None:
        raise ValueError(f"ax must be None for {result.experiment.name}, which creates its own axes")
    figure = shown_figure(width, height)
    from matplotlib.font_manager import FontProperties

    size = FontProperties(size="large").get_size_in_points()
    title = fitted(result.experiment.heading, (1 - 2 * LEFT) * width * 72, size, "bold")
    figure.suptitle(title, x=LEFT, ha="left", fontweight="bold", fontsize=size)
    return figure


def save_plot(result: Result, path: Path) -> None:
    """Writes the figure of a result to a file, completely or not at all, in the format of the path's suffix.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        OSError: if the file cannot be written.
    """
    with not_shown():
        figure: Any = result.plot().figure
    save_figure(figure, path, DOTS_PER_INCH)
