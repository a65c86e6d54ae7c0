"""Example 3.8: the optimal values and policies of a grid world."""

from typing import TYPE_CHECKING

import numpy as np

from qtab.book.drawing import CellMap, draw_grids, greedy_actions
from qtab.book.exact_experiment import ExactExperiment, exact_line
from qtab.book.figures.chapter_03.grid import DISCOUNT, SIZE, as_grid, grid_text
from qtab.book.result import Line, Result
from qtab.envs.small_grid_worlds import grid_world_5x5
from qtab.planning.solve import optimum

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ACTIONS = ("up", "right", "down", "left")


def _compute() -> list[Line]:
    best = optimum(grid_world_5x5(), discount=DISCOUNT, method="value_iteration")
    cells = range(best.values.size)
    actions = [exact_line(f"value of {name}", cells, best.q_values[:, index]) for index, name in enumerate(_ACTIONS)]
    return [exact_line("optimal value", cells, best.values), *actions]


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    if ax is not None:
        raise ValueError("ax must be None for example-3.8, which creates its own axes")
    values, *actions = result.lines
    best = greedy_actions(np.stack([as_grid(line) for line in actions], axis=-1)).reshape(SIZE, SIZE, len(_ACTIONS))
    grids = [CellMap("optimal values", as_grid(values)), CellMap("optimal policies", best=best)]
    return draw_grids(result.experiment.heading, grids, 2)


EXPERIMENT = ExactExperiment(
    name="example-3.8",
    title="optimal values and policies",
    book="the grid world of Example 3.5, γ = 0.9; where there are several arrows, each of the actions is optimal",
    unspecified="",
    compute=_compute,
    draw=_draw,
    names=("optimal value", *(f"value of {name}" for name in _ACTIONS)),
    text=lambda lines: grid_text(lines[:1]),
    x_label="cell",
    y_label="value",
)
