"""Figure 4.3: value iteration for the gambler's problem."""

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from qtab.book.drawing import BROAD, figure_of_several, line_colors, pale
from qtab.book.experiment import ExactExperiment
from qtab.book.line import Line, exact_line
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.envs.book.gamblers_problem import gamblers_problem
from qtab.planning.solve import optimum
from qtab.planning.sweeps import value_iteration
from qtab.plots.parts.labels import finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GOAL = 100
SWEEPS = (1, 2, 3, 32)
FINAL = "final values"
POLICY = "final policy (stake)"


def _compute() -> list[Line]:
    env = gamblers_problem(0.4, GOAL)
    capital = np.arange(1, GOAL)
    after = list(islice(value_iteration(env), SWEEPS[-1] + 1))
    best = optimum(env, method="value_iteration")
    lines = [exact_line(f"sweep {k}", capital, after[k][1:GOAL]) for k in SWEEPS]
    stakes = smallest_best_stakes(best.q_values[1:GOAL])
    return [*lines, exact_line(FINAL, capital, best.values[1:GOAL]), exact_line(POLICY, capital, stakes)]


def smallest_best_stakes(q_values: FloatArray, tolerance: float = 1e-9) -> FloatArray:
    """Returns (states,): the smallest stake among those that are best, up to rounding errors."""
    best = q_values >= q_values.max(axis=1, keepdims=True) - tolerance
    smallest: FloatArray = np.argmax(best, axis=1) + 1.0
    return smallest


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    *values, policy = result.lines
    figure = figure_of_several(result, ax, 8, 7.5)
    upper, lower = figure.subplots(2, sharex=True)
    for line, hue in zip(values, line_colors(values, upper), strict=True):
        # The final values lie behind the others as a broad band: sweep 32 has almost reached them.
        style = {**BROAD, "color": pale(hue, upper)} if line.name == FINAL else {"linewidth": 1.8, "color": hue}
        upper.plot(line.x, line.mean, label=line.name, **style)
    finish(upper, "", "value: the probability of winning")
    lower.bar(policy.x, policy.mean, width=1.0, color=line_colors([policy], lower)[0])
    finish(lower, "capital", POLICY)
    last: Axes = lower
    return last


EXPERIMENT = ExactExperiment(
    name="figure-4.3",
    title="value iteration for the gambler's problem",
    book="heads with a probability of 0.4, a goal of 100, undiscounted; the values after sweeps 1, 2, 3 and 32, the "
    "final values, and the final policy",
    unspecified="which of the optimal policies is drawn (the smallest stake here; a stake of 0 is left out); the "
    "sweeps are in place, by increasing capital",
    compute=_compute,
    draw=_draw,
    names=(*(f"sweep {k}" for k in SWEEPS), FINAL, POLICY),
    x_label="capital",
    y_label="value or stake",
    table_x=(1, 12, 25, 37, 50, 51, 63, 75, 88, 99),
)
