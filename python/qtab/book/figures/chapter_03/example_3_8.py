"""Example 3.8: the optimal values and policies of a grid world."""

from typing import TYPE_CHECKING

import numpy as np

from qtab.book.drawing import CellMap, draw_grids, greedy_actions
from qtab.book.drawing.grids import ACTIONS
from qtab.book.experiment import ExactExperiment
from qtab.book.figures.grid import as_grid, grid_text
from qtab.book.line import Line, exact_line
from qtab.book.result import Result
from qtab.envs.grid_worlds import GRID_WORLD_5X5, grid_world_5x5
from qtab.planning.solve import optimum

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def _compute() -> list[Line]:
    best = optimum(grid_world_5x5(), discount=0.9, method="value_iteration")
    cells = range(best.values.size)
    actions = [exact_line(f"value of {name}", cells, best.q_values[:, index]) for index, name in enumerate(ACTIONS)]
    return [exact_line("optimal value", cells, best.values), *actions]


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    values, *actions = result.lines
    best = greedy_actions(np.stack([as_grid(line) for line in actions], axis=-1))
    grids = [
        CellMap("optimal values", GRID_WORLD_5X5, as_grid(values)),
        CellMap("optimal policies", GRID_WORLD_5X5, best=best),
    ]
    return draw_grids(result, ax, grids, 2)


EXPERIMENT = ExactExperiment(
    name="example-3.8",
    title="optimal values and policies",
    book="the grid world of Example 3.5, γ = 0.9; where there are several arrows, each of the actions is optimal",
    unspecified="",
    compute=_compute,
    draw=_draw,
    names=("optimal value", *(f"value of {name}" for name in ACTIONS)),
    text=lambda lines: grid_text(lines[:1]),
    x_label="cell",
    y_label="value",
)
