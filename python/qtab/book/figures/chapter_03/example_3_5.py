"""Example 3.5: the values of the random policy in a grid world."""

from typing import TYPE_CHECKING

from qtab.book.drawing import CellMap, draw_grids
from qtab.book.experiment import ExactExperiment
from qtab.book.figures.grid import as_grid, grid_text
from qtab.book.line import Line, exact_line
from qtab.book.result import Result
from qtab.envs.grid_worlds import GRID_WORLD_5X5, grid_world_5x5
from qtab.planning.policy_values import policy_values

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def _compute() -> list[Line]:
    values = policy_values(grid_world_5x5(), "random", 0.9).values
    return [exact_line("random policy", range(len(values)), values)]


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    return draw_grids(result, ax, [CellMap("", GRID_WORLD_5X5, as_grid(result.lines[0]))], 1)


EXPERIMENT = ExactExperiment(
    name="example-3.5",
    title="values of the random policy",
    book="5 rows and 5 columns, γ = 0.9; from A to A' with a reward of 10, from B to B' with a reward of 5; a move off "
    "the grid has a reward of -1",
    unspecified="",
    compute=_compute,
    draw=_draw,
    names=("random policy",),
    text=grid_text,
    x_label="cell",
    y_label="value",
)
