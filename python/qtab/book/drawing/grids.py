"""Grid worlds of the book's figures: a number in each cell, and arrows for the actions of a policy."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.book.drawing.figures import figure_of_several
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.plots.arrangements.grid_map import grid_map
from qtab.plots.parts.panels import draw_heat_map, finish_panel
from qtab.plots.policy import draw_moves
from qtab.plots.values import common_norm

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ACTIONS = ("up", "right", "down", "left")
CELL = 0.55
"""The width of a cell in inches."""


@dataclass(frozen=True, eq=False)
class CellMap:
    """A picture of a grid, with values as numbers or the actions of a policy as arrows."""

    title: str
    layout: Sequence[str]
    """The map of the grid; see :mod:`qtab.plots.arrangements.grid_map`."""
    values: FloatArray | None = None
    """(rows, columns): the numbers."""
    best: NDArray[np.bool_] | None = None
    """(rows, columns, 4): whether the policy takes each action."""


def greedy_actions(q_values: FloatArray, tolerance: float = 1e-9) -> NDArray[np.bool_]:
    """Returns (..., actions): whether each action has the largest value, up to rounding errors."""
    best: NDArray[np.bool_] = q_values >= q_values.max(axis=-1, keepdims=True) - tolerance
    return best


def draw_grids(result: Result, ax: "Axes | None", grids: Sequence[CellMap], columns: int) -> "Axes":
    """Draws grids in rows and columns of a new figure; returns the last axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if ``ax`` is not None.
    """
    rows, height, width = -(-len(grids) // columns), len(grids[0].layout), len(grids[0].layout[0])
    figure = figure_of_several(result, ax, columns * (width * CELL + 0.5), rows * (height * CELL + 0.4) + 0.5)
    axes: Any = figure.subplots(rows, columns, squeeze=False)
    for part in axes.flat[len(grids) :]:
        part.remove()
    shown = [np.where(grid_map(grid.layout).rows[..., 0] >= 0, one, np.nan) for grid in grids for one in _values(grid)]
    norm = common_norm(shown or [np.zeros(1)])
    for part, grid in zip(axes.flat, grids, strict=False):
        raster = grid_map(grid.layout)
        if grid.values is not None:
            draw_heat_map(part, raster, shown.pop(0), norm, grid.title, _text)
        if grid.best is not None:
            draw_moves(part, raster, grid.best & (raster.rows >= 0), ACTIONS)
            finish_panel(part, raster, grid.title)
        part.set(xlabel="", ylabel="", xticks=[], yticks=[])
    last: Axes = axes.flat[len(grids) - 1]
    return last


def _values(grid: CellMap) -> list[FloatArray]:
    return [] if grid.values is None else [grid.values]


def _text(value: float) -> str:
    text = f"{value:.1f}"
    return text.removeprefix("-") if float(text) == 0 else text
