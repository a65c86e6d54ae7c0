"""Figure 4.1: iterative policy evaluation on a small grid world."""

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from qtab.book.drawing import CellMap, draw_grids, greedy_actions
from qtab.book.experiment import ExactExperiment
from qtab.book.figures.grid import as_grid, grid_text
from qtab.book.line import Line, exact_line
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.envs.grid_worlds import GRID_WORLD_4X4, grid_world_4x4
from qtab.planning.policy_values import policy_values
from qtab.planning.sweeps import policy_evaluation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = 4
SWEEPS = (0, 1, 2, 3, 10)
_MOVES = ((-1, 0), (0, 1), (1, 0), (0, -1))


def _compute() -> list[Line]:
    env = grid_world_4x4()
    # Each of the book's sweeps uses the old values of all states.
    after = list(islice(policy_evaluation(env, "random", in_place=False), SWEEPS[-1] + 1))
    values = {f"k = {k}": after[k] for k in SWEEPS} | {"k = ∞": policy_values(env, "random").values}
    return [exact_line(name, range(SIZE * SIZE), one) for name, one in values.items()]


def next_values(values: FloatArray) -> FloatArray:
    """Returns (rows, columns, 4): the value of the cell that each action leads to."""
    padded = np.pad(values, 1, mode="edge")
    return np.stack([padded[1 + down :, 1 + right :][:SIZE, :SIZE] for down, right in _MOVES], axis=-1)


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    grids = []
    for line in result.lines:
        values = as_grid(line)
        grids.append(CellMap(f"{line.name}: values", GRID_WORLD_4X4, values))
        best = greedy_actions(next_values(values))
        grids.append(CellMap(f"{line.name}: greedy policy", GRID_WORLD_4X4, best=best))
    return draw_grids(result, ax, grids, 4)


EXPERIMENT = ExactExperiment(
    name="figure-4.1",
    title="iterative policy evaluation on a small grid world",
    book="4 rows and 4 columns, a reward of -1 per step, undiscounted; the values of the random policy after k sweeps, "
    "and the greedy policy for them",
    unspecified="",
    compute=_compute,
    draw=_draw,
    names=(*(f"k = {k}" for k in SWEEPS), "k = ∞"),
    text=grid_text,
    x_label="cell",
    y_label="value",
)
