"""Grid worlds of the book's figures: a number in each cell, and arrows for the actions of a policy."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.book.drawing.titles import title_figure
from qtab.book.runner import FloatArray
from qtab.plots.axes import shown_figure
from qtab.plots.colors import COLORS, readable, text_color

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ARROWS = ((0, -1), (1, 0), (0, 1), (-1, 0))
"""The directions of the actions up, right, down and left, in columns and rows."""
CELL = 0.55
"""The width of a cell in inches."""
_LENGTH = 0.32


@dataclass(frozen=True, eq=False)
class CellMap:
    """A grid to draw."""

    title: str
    values: FloatArray | None = None
    """(rows, columns): the numbers."""
    best: NDArray[np.bool_] | None = None
    """(rows, columns, 4): which actions the policy takes."""
    digits: int = 1
    terminal: Sequence[tuple[int, int]] = ()
    """Cells that are shaded."""


def greedy_actions(q_values: FloatArray, tolerance: float = 1e-9) -> NDArray[np.bool_]:
    """Returns (..., actions): which actions have the largest value, up to rounding errors."""
    best: NDArray[np.bool_] = q_values >= q_values.max(axis=-1, keepdims=True) - tolerance
    return best


def draw_grids(title: str, grids: Sequence[CellMap], columns: int) -> "Axes":
    """Draws grids beside and below each other in a new figure; returns the last axes."""
    shape = next(np.shape(part)[:2] for one in grids for part in (one.values, one.best) if part is not None)
    rows = -(-len(grids) // columns)
    figure = shown_figure(columns * (shape[1] * CELL + 0.5), rows * (shape[0] * CELL + 0.4) + 0.5)
    title_figure(figure, title)
    axes: Any = figure.subplots(rows, columns, squeeze=False)
    for ax in axes.flat[len(grids) :]:
        ax.remove()
    for ax, grid in zip(axes.flat, grids, strict=False):
        _draw(ax, grid, shape)
    last: Axes = axes.flat[len(grids) - 1]
    return last


def _draw(ax: Any, grid: CellMap, shape: tuple[int, ...]) -> None:
    rows, columns = shape
    ax.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5), aspect="equal", xticks=[], yticks=[])
    ax.set_title(grid.title, fontsize="small")
    for edge in range(1, max(rows, columns)):
        ax.axhline(edge - 0.5, color=text_color(), linewidth=0.6)
        ax.axvline(edge - 0.5, color=text_color(), linewidth=0.6)
    for row, column in grid.terminal:
        ax.fill([column - 0.5, column + 0.5, column + 0.5, column - 0.5], [row - 0.5] * 2 + [row + 0.5] * 2, "0.75")
    hue = readable(COLORS[0], ax)
    for row, column in np.ndindex(rows, columns):
        if (row, column) in grid.terminal and grid.values is None:
            continue
        if grid.values is not None:
            number = f"{grid.values[row, column]:.{grid.digits}f}"
            number = number.removeprefix("-") if float(number) == 0 else number
            ax.text(column, row, number, ha="center", va="center", fontsize="small")
        if grid.best is not None:
            for action in np.flatnonzero(grid.best[row, column]):
                x, y = ARROWS[action]
                end = column + _LENGTH * x, row + _LENGTH * y
                ax.annotate("", end, (column, row), arrowprops={"arrowstyle": "->", "color": hue, "shrinkA": 0})
