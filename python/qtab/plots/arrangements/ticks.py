"""Ticks with names: as many as there is room for."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LETTER = 0.62
"""The width of a letter, in heights of it."""
POINTS = 10.0
"""The usual size of a letter."""
LETTERS_ACROSS = 10
"""Names of at most so many letters are written from left to right."""
MOST_UPRIGHT = 24
LONG = 28
"""Longer names are cut."""


def thinned(count: int, most: int) -> list[int]:
    """Returns the indices of at most ``most`` of ``count`` ticks, from the first on, at equal distances."""
    step = -(-count // most)
    return list(range(0, count, step))


def line_height(names: Sequence[str]) -> float:
    """Returns the height in inches of a picture of cells in a line, with their names below."""
    longest = max(map(len, names), default=0)
    return 2.0 if longest <= LETTERS_ACROSS else 2.0 + min(longest, LONG) * LETTER * POINTS / 72


def name_ticks(ax: "Axes", names: Sequence[str], first: float = 0.5) -> None:
    """Writes the names of cells along the x axis, as many as fit; long ones upright.

    Args:
        ax: The axes, with their limits.
        names: A name for each cell.
        first: The middle of the first cell; the others follow at a distance of 1.
    """
    width = ax.get_window_extent().width * 72 / ax.figure.dpi
    size = float(ax.xaxis.label.get_fontsize())
    cut = [name if len(name) <= LONG else f"{name[: LONG - 1]}…" for name in names]
    fit = int(width / ((max(map(len, cut)) + 1.5) * LETTER * size))
    upright = fit < len(cut) and max(map(len, cut)) > LETTERS_ACROSS
    kept = thinned(len(cut), max(1, min(MOST_UPRIGHT, int(width / (1.6 * size))) if upright else fit))
    ax.set_xticks([first + index for index in kept], [cut[index] for index in kept], rotation=90 if upright else 0)
    if upright:
        ax.tick_params(axis="x", labelsize="small")
