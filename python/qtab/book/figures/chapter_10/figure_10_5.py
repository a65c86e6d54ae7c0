"""Figure 10.5: differential Sarsa on the access-control queue."""

from typing import TYPE_CHECKING, Any

import numpy as np

from qtab import _core
from qtab._utils.progress import ProgressBar
from qtab.book.drawing import draw_band, figure_of_several, line_colors
from qtab.book.experiment import Experiment, Outcome
from qtab.book.line import LineStyle, line_from_samples
from qtab.book.result import Result
from qtab.training.setup.resolve import resolve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STEPS = 2_000_000
SERVERS = 10
PRIORITIES = (1, 2, 4, 8)
AVERAGE = "average reward"
CONFIG: dict[str, Any] = {
    "algorithm": "differential_sarsa",
    "learning_rate": 0.01,
    "reward_learning_rate": 0.01,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "max_episode_steps": STEPS,
    "episodes": 1,
}
"""The keyword arguments of :func:`qtab.train`: one episode that the time limit ends."""


def draw_queue(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the greedy policy for the average of the runs, and its values below; returns the lower axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if ``ax`` is not None.
    """
    from matplotlib.colors import ListedColormap

    figure = figure_of_several(result, ax, 7, 7)
    upper, lower = figure.subplots(2, 1, height_ratios=(1, 2), sharex=True)
    # Without a free server there is nothing to choose: every customer is rejected.
    policy = result.surfaces["policy"].T[:, 1:]
    free, levels = np.arange(SERVERS + 1), np.arange(len(PRIORITIES))
    upper.pcolormesh(
        free[1:], levels, policy, cmap=ListedColormap(("#f3c9a6", "#d9e4f2")), vmin=0, vmax=1, edgecolors="white"
    )
    for action, word in enumerate(("REJECT", "ACCEPT")):
        where = np.argwhere(policy == action)
        if len(where):  # in the cell that is nearest to the middle
            height, across = where[np.abs(where - where.mean(axis=0)).sum(axis=1).argmin()]
            upper.text(across + 1, height, word, ha="center", va="center", color="black")
    upper.set_yticks(levels, PRIORITIES)
    upper.invert_yaxis()
    upper.set(ylabel="priority", title="policy")
    drawn = [line for line in result.lines if line.drawn]
    for line, hue in zip(drawn, line_colors(drawn, lower), strict=True):
        draw_band(lower, line, hue)
        lower.plot(line.x, line.mean, color=hue, marker="o", markersize=4, label=line.name)
    lower.legend(loc="upper left", frameon=False, reverse=True)
    lower.axhline(0, color="0.6", linewidth=0.8)
    lower.set_xlim(-0.5, SERVERS + 0.5)
    lower.set_xticks(free)
    lower.set(xlabel=result.experiment.x_label, ylabel="differential value of the best action", title="values")
    axes: Axes = lower
    return axes


class AccessControl(Experiment):
    """Runs of differential Sarsa on the access-control queue."""

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:  # noqa: ARG002
        """Trains with every seed; the figure shows the average of their values."""
        tables, averages = [], []
        resolved = resolve("qtab/AccessControlQueue-v0", {**CONFIG, "seed": seed})
        with ProgressBar(runs, "run", progress, self.name) as bar:
            for number in range(runs):
                trainer = _core.Trainer(resolved.spec(), seed + number)
                trainer.advance(1)
                tables.append(trainer.tables().reshape(SERVERS + 1, len(PRIORITIES), 2))
                averages.append(trainer.average_reward() or 0.0)
                bar.move_to(number + 1)
        values = np.stack(tables).max(axis=-1)
        samples = [*np.moveaxis(values, -1, 0), np.array(averages)[:, None]]
        lines = [
            line_from_samples(name, np.arange(sample.shape[1]), sample, style=LineStyle(drawn=name != AVERAGE))
            for name, sample in zip(self.line_names, samples, strict=True)
        ]
        return Outcome(lines, {"policy": np.mean(tables, axis=0).argmax(axis=-1).astype(np.float64)})


EXPERIMENT = AccessControl(
    name="figure-10.5",
    title="differential Sarsa on the access-control queuing task",
    book="10 servers, priorities 1, 2, 4 and 8 with equal probability, a busy server becomes free with probability "
    "0.06; α = β = 0.01, ε = 0.1, initial values and average reward of zero, 2,000,000 steps",
    unspecified="how ties are broken (at random here). The values are the average of 30 runs; the policy is greedy for "
    "this average",
    runs=30,
    x_label="number of free servers",
    y_label="differential value",
    draw=draw_queue,
    names=(*(f"priority = {priority}" for priority in PRIORITIES), AVERAGE),
)
