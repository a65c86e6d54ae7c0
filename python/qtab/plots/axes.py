"""Helpers that all plots share: axes, colors, labels, and the files they are saved to."""

from pathlib import Path
from typing import TYPE_CHECKING

from qtab._utils.extras import missing
from qtab._utils.files import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from qtab.planning import Optimum

COLORS = ("#1f5fa8", "#d1662b", "#2f8f5b", "#8a4fa3", "#b0892b", "#4b8fa8", "#b03a48", "#5b5b5b")
"""Colors that differ in lightness, and that most color-blind readers can distinguish."""


def color(index: int) -> str:
    """Returns the color of a line by its index."""
    return COLORS[index % len(COLORS)]


def new_figure(width: float = 8, height: float = 4.5) -> "Figure":
    """Returns an empty figure; width and height are in inches.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
    """
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise missing(error, "plot") from None
    return Figure(figsize=(width, height), layout="constrained")


def axes_or_new(ax: "Axes | None") -> "Axes":
    """Returns the given axes, or those of a new figure.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
    """
    return new_figure().subplots() if ax is None else ax


def mark_optimum(ax: "Axes", optimum: "Optimum | float | None") -> None:
    """Draws a dashed horizontal line at an optimum or a return, with the number in the legend.

    Raises:
        TypeError: if ``optimum`` is neither of them.
    """
    if optimum is None:
        return
    if not hasattr(optimum, "expected_return") and not isinstance(optimum, int | float):
        raise TypeError(f"optimum must be a number or a result of qtab.optimum, got {optimum!r}")
    value, label = (
        (float(optimum), "optimum") if isinstance(optimum, int | float) else (optimum.expected_return, optimum.label)
    )
    ax.axhline(value, color="#a3262f", linestyle=(0, (5, 3)), linewidth=1.5, label=f"{label} {value:.4g}", zorder=4)


def finish(ax: "Axes", x_label: str, y_label: str, title: str = "") -> "Axes":
    """Adds labels, a grid and a legend to the axes, removes the top and right spines, and returns the axes."""
    ax.set_xlabel(x_label)
    ax.set_ylabel(y_label)
    if title:
        ax.set_title(title, loc="left", fontweight="bold")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    handles, _ = ax.get_legend_handles_labels()
    if handles:
        ax.legend(framealpha=0.85, edgecolor="none")
    return ax


def check_format(name: str, path: Path) -> None:
    """Checks that the suffix of a path is an image format that matplotlib can write.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: for another suffix; the message lists the known ones.
    """
    formats = sorted(new_figure().canvas.get_supported_filetypes())
    if path.suffix.lower().removeprefix(".") not in formats:
        raise ValueError(f"{name} must end in one of .{', .'.join(formats)}, got {str(path)!r}")


def save_figure(figure: "Figure", path: Path, dots_per_inch: int) -> None:
    """Writes a figure to a file, completely or not at all; the suffix of the path determines the format.

    Raises:
        OSError: if the file cannot be written.
    """
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=dots_per_inch)
