"""Figure 8.8: updates distributed uniformly and on-policy."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from qtab._utils.progress import ProgressBar
from qtab.book.drawing import draw_band, figure_of_several, line_colors
from qtab.book.experiment import Experiment, Outcome
from qtab.book.line import Line, LineStyle, line_from_samples
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.envs.book.random_mdp import random_mdp
from qtab.planning.expected_updates import ExpectedUpdates
from qtab.plots.parts.labels import finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

T = TypeVar("T")
DISTRIBUTIONS = {"on-policy": "on_policy", "uniform": "uniform"}
STYLES = {1: "-", 3: "--", 10: ":"}
"""The line style for each number of next states."""


@dataclass(frozen=True)
class Tasks:
    """Random tasks of one size."""

    states: int
    branching: int
    updates: int
    """The number of updates."""

    def line_name(self, distribution: str) -> str:
        """Returns the name of the line of a distribution."""
        return f"{distribution}, b = {self.branching}, {self.states:,} states"


@dataclass(frozen=True, kw_only=True, repr=False)
class UpdateDistributions(Experiment):
    """The value of the greedy policy after more and more updates, for two distributions of the updates."""

    tasks: Sequence[Tasks]
    parts: Sequence[float]
    """The fractions of all updates after which the greedy policy is evaluated."""

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        return [one.line_name(distribution) for one in self.tasks for distribution in DISTRIBUTIONS]

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:
        """Plans in ``runs`` random tasks of each size."""
        lines: list[Line] = []
        with ProgressBar(runs * len(self.tasks), "task", progress, self.name) as bar:
            for index, size in enumerate(self.tasks):
                measured: list[dict[str, FloatArray]] = []
                for one in _in_threads(threads, partial(self._measure, size), range(seed, seed + runs)):
                    measured.append(one)
                    bar.move_to(index * runs + len(measured))
                for name in DISTRIBUTIONS:
                    lines.append(self._line(size, name, np.array([one[name] for one in measured])))
        return Outcome(lines)

    def _measure(self, size: Tasks, seed: int) -> dict[str, FloatArray]:
        env = random_mdp(size.states, size.branching, seed)
        values = {}
        for name, distribution in DISTRIBUTIONS.items():
            planning = ExpectedUpdates(env, distribution, seed=seed)
            measured = [planning.greedy_return()]
            for before, after in pairwise(self._times(size)):
                planning.advance(after - before)
                measured.append(planning.greedy_return())
            values[name] = np.array(measured)
        return values

    def _times(self, size: Tasks) -> list[int]:
        return [round(part * size.updates) for part in self.parts]

    def _line(self, size: Tasks, distribution: str, samples: FloatArray) -> Line:
        return line_from_samples(
            size.line_name(distribution), self._times(size), samples, style=LineStyle(method=distribution)
        )


def _in_threads(threads: int, measure: Callable[[int], T], seeds: range) -> Iterator[T]:
    """Yields the result of a function for each seed, in order. After Ctrl-C no further call starts."""
    with ThreadPoolExecutor(threads) as pool:
        try:
            yield from pool.map(measure, seeds)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def draw_two_sizes(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the tasks of each number of states on separate axes; returns the last axes.

    Raises:
        ValueError: if ``ax`` is not None.
    """
    experiment: Any = result.experiment
    sizes = list(dict.fromkeys(one.states for one in experiment.tasks))
    figure = figure_of_several(result, ax, 8, 4.5 * len(sizes))
    panels: Any = figure.subplots(len(sizes), squeeze=False)[:, 0]
    lines = dict(zip(experiment.line_names, result.lines, strict=True))
    for panel, states in zip(panels, sizes, strict=True):
        shown = [(one, name) for one in experiment.tasks if one.states == states for name in DISTRIBUTIONS]
        chosen = [lines[one.line_name(name)] for one, name in shown]
        for line, hue, (one, name) in zip(chosen, line_colors(chosen, panel), shown, strict=True):
            draw_band(panel, line, hue, alpha=0.2)
            style = STYLES.get(one.branching, "-")
            panel.plot(line.x, line.mean, style, color=hue, label=f"{name}, b = {one.branching}")
        panel.xaxis.set_major_formatter("{x:,.0f}")
        finish(panel, experiment.x_label, experiment.y_label)
        panel.set_title(f"{states:,} states", loc="left", fontsize="medium")
    last: Axes = panels[-1]
    return last


EXPERIMENT = UpdateDistributions(
    name="figure-8.8",
    title="updates distributed uniformly and on-policy",
    book="two actions, each with b next states, equally likely; rewards from a normal distribution of mean 0 and "
    "variance 1; every transition ends the episode with a probability of 0.1; undiscounted; on-policy with ε = 0.1; "
    "200 random tasks",
    unspecified="whether the b next states are different (drawn with replacement here), the initial values (zero "
    "here), the order of the uniform updates (by state and action here), and how ties are broken (at random in "
    "episodes, the first in the greedy policy that is measured)",
    tasks=(Tasks(1000, 1, 20_000), Tasks(1000, 3, 20_000), Tasks(1000, 10, 20_000), Tasks(10_000, 1, 200_000)),
    parts=(0, 0.025, 0.05, 0.075, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0),
    runs=200,
    x_label="expected updates",
    y_label="value of the start state",
    draw=draw_two_sizes,
)
