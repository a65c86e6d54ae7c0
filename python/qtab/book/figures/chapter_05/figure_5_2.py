"""Figure 5.2: blackjack by Monte Carlo with exploring starts: the optimal policy and its values."""

from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils.checks import required
from qtab._utils.progress import ProgressBar
from qtab.book.drawing.blackjack import USABLE, draw_blackjack
from qtab.book.experiment import Experiment, Outcome
from qtab.book.line import line_from_samples
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.training.train_many import train_many

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STICK = 0
SUMS = range(11, 22)
"""The sums of the player that the figure shows."""

CONFIG: dict[str, Any] = {
    "env": "Blackjack-v1",
    "env_kwargs": {"sab": True},
    "algorithm": "monte_carlo_es",
    "discount": 1.0,
    "initial_q": 0.0,
    "max_episode_steps": 100,  # more cards than any hand has
    "episodes": 5_000_000,
}
"""The keyword arguments of :func:`qtab.train`."""


def values_of(table: FloatArray) -> FloatArray:
    """Returns (actions, usable ace, sums, dealer's cards) of a table of Gymnasium's observations."""
    shape = (32, 11, 2, 2)
    values: FloatArray = table.reshape(shape)[SUMS.start : SUMS.stop, 1:].transpose(3, 2, 0, 1)
    return values


def lowest_stick(values: FloatArray) -> FloatArray:
    """Returns (usable ace, dealer's cards): the lowest sum such that the greedy policy sticks on it and all above."""
    sticks = values.argmax(axis=0) == STICK
    from_here_on = np.flip(np.cumprod(np.flip(sticks, axis=1), axis=1), axis=1)
    lowest: FloatArray = SUMS.stop - from_here_on.sum(axis=1).astype(np.float64)
    return lowest


def draw_optimum(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the greedy policy and the values in a new figure, and returns the axes of the values."""
    tables = {name: table[:, 12 - SUMS.start :] for name, table in result.surfaces.items()}
    values = {name: table.max(axis=0) for name, table in tables.items()}
    policy = {name: table.argmax(axis=0) for name, table in tables.items()}
    return draw_blackjack(result, ax, {"values": values}, {"policy": policy})


class ExploringStarts(Experiment):
    """Runs of Monte Carlo ES on blackjack."""

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:
        """Trains with every seed; the figure shows the average of their values."""
        tables = []
        with ProgressBar(runs, "run", progress, self.name) as bar:
            for first in range(0, runs, threads):
                seeds = range(seed + first, seed + min(first + threads, runs))
                trained = train_many(**CONFIG, seeds=seeds, tables=True, threads=threads, progress=False)
                tables += [values_of(table) for table in required("tables", trained.tables)]
                bar.move_to(len(tables))
        thresholds = np.stack([lowest_stick(values) for values in tables])
        mean, aces = np.mean(tables, axis=0), dict(zip(USABLE, (1, 0), strict=True))
        cards = np.arange(1, thresholds.shape[-1] + 1)
        lines = [line_from_samples(name, cards, thresholds[:, ace]) for name, ace in aces.items()]
        return Outcome(lines, {name: mean[:, ace] for name, ace in aces.items()})


EXPERIMENT = ExploringStarts(
    name="figure-5.2",
    title="the optimal policy of blackjack, by Monte Carlo with exploring starts",
    book="exploring starts, γ = 1, initial values of zero, at first a policy that sticks on 20 and 21 only; one run",
    unspecified="the number of episodes (5,000,000 here). The figure shows the average of 10 runs. The book draws the "
    "first cards so that all starts have the same probability; here they are dealt, and only the first action is "
    "drawn. The first policy sticks everywhere, as all values are zero",
    runs=10,
    x_label="dealer's card",
    y_label="lowest sum that sticks",
    draw=draw_optimum,
    names=USABLE,
)
