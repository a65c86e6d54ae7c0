"""What the pictures have in common."""

from typing import TYPE_CHECKING

from qtab._utils.extras import missing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

COLORS = ("#1f5fa8", "#d1662b", "#2f8f5b", "#8a4fa3", "#b0892b", "#4b8fa8", "#b03a48", "#5b5b5b")
"""Told apart in grey and by most colour-blind readers."""


def color(index: int) -> str:
    """Returns the colour of a line by its number."""
    return COLORS[index % len(COLORS)]


def own_axes(ax: "Axes | None") -> "Axes":
    """Returns the axes to draw on; a figure of their own where none are given.

    Raises:
        ModuleNotFoundError: without matplotlib; it names the ``pip install``.
    """
    if ax is not None:
        return ax
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise missing(error, "plot") from None
    return Figure(figsize=(8, 4.5), layout="constrained").subplots()


def mark_optimum(ax: "Axes", optimum: "Optimum | float | None") -> None:
    """Draws a dashed line at the optimum, or at a return of one's own, with its number in the legend."""
    if optimum is None:
        return
    if not hasattr(optimum, "expected_return") and not isinstance(optimum, int | float):
        raise TypeError(f"optimum must be a number, or what qtab.optimum returns, got {optimum!r}")
    value, label = (
        (float(optimum), "optimum") if isinstance(optimum, int | float) else (optimum.expected_return, optimum.label)
    )
    ax.axhline(value, color="#a3262f", linestyle=(0, (5, 3)), linewidth=1.5, label=f"{label} {value:.4g}", zorder=4)


def finish(ax: "Axes", x: str, y: str, title: str = "") -> "Axes":
    """Labels the axes, and takes away what says nothing."""
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    if title:
        ax.set_title(title, loc="left", fontweight="bold")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    handles, _ = ax.get_legend_handles_labels()
    if handles:
        ax.legend(framealpha=0.85, edgecolor="none")
    return ax
