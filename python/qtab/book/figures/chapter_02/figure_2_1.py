"""Figure 2.1: an exemplary problem of the 10-armed testbed."""

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from qtab.book.experiment import ComputedExperiment
from qtab.book.line import Line, exact_line
from qtab.book.result import Result
from qtab.book.testbed import ENV
from qtab.plots.parts.axes import axes_or_new
from qtab.plots.parts.colors import COLORS, readable
from qtab.plots.parts.labels import finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

VALUES = "true value"
SPREAD = 3.0
"""The width of a distribution on each side, in standard deviations of the rewards."""
HALF_WIDTH = 0.4
"""The largest half width of a distribution, where actions are 1 apart."""


class ExemplaryProblem(ComputedExperiment):
    """The problem that the testbed draws with a seed: the true values and the distributions of the rewards."""

    def lines(self, seed: int) -> Sequence[Line]:
        """Draws the problem."""
        env = gym.make(ENV)
        env.reset(seed=seed)
        values = env.get_wrapper_attr("action_values")
        env.close()
        return [exact_line(VALUES, np.arange(1, len(values) + 1), values)]

    def conditions(self, counts: Collection[int], runs: int, seed: int) -> str:  # noqa: ARG002
        """Describes in words how a result was computed."""
        return f"the problem of seed {seed}; the distributions are exact"


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    """Draws a violin for each action: the density of its rewards, with its true value as a line."""
    ax = axes_or_new(ax)
    [line], hue = result.lines, readable(COLORS[0], ax)
    deviations = np.linspace(-SPREAD, SPREAD, 121)
    widths = HALF_WIDTH * np.exp(-0.5 * deviations**2)
    for action, value in zip(line.x, line.mean, strict=True):
        ax.fill_betweenx(value + deviations, action - widths, action + widths, color=hue, alpha=0.35, linewidth=0)
        # Away from the line at 0.
        side: Any = "bottom" if value >= 0 else "top"
        offset = (0, 3 if value >= 0 else -3)
        text = f"{value:.2f}"
        ax.annotate(text, (action, value), offset, textcoords="offset points", ha="center", va=side, fontsize=9)
    ax.hlines(line.mean, line.x - HALF_WIDTH, line.x + HALF_WIDTH, color=hue, linewidth=1.6)
    ax.axhline(0.0, color="0.45", linewidth=1, linestyle="--")
    ax.set_xlim(0.4, line.x[-1] + 0.6)
    ax.set_xticks(line.x, [f"{action:g}" for action in line.x])
    finish(ax, result.experiment.x_label, result.experiment.y_label, result.experiment.heading)
    return ax


EXPERIMENT = ExemplaryProblem(
    name="figure-2.1",
    title="an exemplary bandit problem from the 10-armed testbed",
    book="ten actions; true values of mean 0 and variance 1, rewards normal with mean q*(a) and variance 1",
    unspecified="the true values (drawn with the seed here); actions are numbered from 1, as in the book",
    x_label="action",
    y_label="reward distribution",
    names=[VALUES],
    draw=_draw,
)
