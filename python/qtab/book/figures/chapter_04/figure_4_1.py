"""Figure 4.1: iterative policy evaluation on a small grid world."""

from collections.abc import Sequence
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from qtab.book.drawing import CellMap, draw_grids, greedy_actions
from qtab.book.exact_experiment import ExactExperiment, exact_line
from qtab.book.result import Line, Result
from qtab.book.runner import FloatArray
from qtab.envs.small_grid_worlds import grid_world_4x4
from qtab.planning.policy_values import policy_values
from qtab.planning.sweeps import policy_evaluation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = 4
SWEEPS = (0, 1, 2, 3, 10)
TERMINAL = ((0, 0), (SIZE - 1, SIZE - 1))
_MOVES = ((-1, 0), (0, 1), (1, 0), (0, -1))


def _compute() -> list[Line]:
    env = grid_world_4x4()
    # The book's sweeps take the old values of all states.
    after = list(islice(policy_evaluation(env, "random", in_place=False), SWEEPS[-1] + 1))
    values = {f"k = {k}": after[k] for k in SWEEPS} | {"k = ∞": policy_values(env, "random").values}
    return [exact_line(name, range(SIZE * SIZE), one) for name, one in values.items()]


def as_grid(line: Line) -> FloatArray:
    """Returns (rows, columns): the numbers of a line."""
    return line.mean.reshape(SIZE, SIZE)


def next_values(values: FloatArray) -> FloatArray:
    """Returns (rows, columns, 4): the value of the cell that each action leads to."""
    padded = np.pad(values, 1, mode="edge")
    return np.stack([padded[1 + down :, 1 + right :][:SIZE, :SIZE] for down, right in _MOVES], axis=-1)


def _text(lines: Sequence[Line]) -> str:
    grids = ["\n".join("".join(f"{value:7.1f}" for value in row) for row in as_grid(line)) for line in lines]
    return "\n\n".join(f"{line.name}\n{grid}" for line, grid in zip(lines, grids, strict=True))


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    if ax is not None:
        raise ValueError("ax must be None for figure-4.1, which creates its own axes")
    grids = []
    for line in result.lines:
        values = as_grid(line)
        grids.append(CellMap(f"{line.name}: values", values, terminal=TERMINAL))
        best = greedy_actions(next_values(values))
        grids.append(CellMap(f"{line.name}: greedy policy", best=best, terminal=TERMINAL))
    return draw_grids(result.experiment.heading, grids, 4)


EXPERIMENT = ExactExperiment(
    name="figure-4.1",
    title="iterative policy evaluation on a small grid world",
    book="4 rows and 4 columns, a reward of -1 per step, undiscounted; the values of the random policy after k sweeps, "
    "and the greedy policy for them",
    unspecified="",
    compute=_compute,
    draw=_draw,
    names=(*(f"k = {k}" for k in SWEEPS), "k = ∞"),
    text=_text,
    x_label="cell",
    y_label="value",
)
