"""The rates of each episode of a run, even if it was resumed with more episodes while a rate fell."""

import numpy as np
from numpy.typing import NDArray

from qtab.config.schedules import Schedule
from qtab.results.run import Run


def rates_of(run: Run, schedule: Schedule, episodes: NDArray[np.int64]) -> NDArray[np.float64]:
    """Returns (n,): the value that a schedule of the run's config had in each of n episodes, numbered from 0.

    Each extension spreads a linear fall over the new number of episodes, from the first episode on.
    """
    totals = np.full(len(episodes), run.config.episodes)
    extensions = () if run.state is None else run.state.extensions
    for finished, total in reversed(extensions):
        totals[episodes < finished] = total
    pairs = zip(episodes.tolist(), totals.tolist(), strict=True)
    return np.array([schedule.after(episode, total) for episode, total in pairs])
