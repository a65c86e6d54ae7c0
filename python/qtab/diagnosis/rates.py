"""The exploration rate and the learning rate over the episodes of a run."""

import numpy as np
from numpy.typing import NDArray

from qtab.config.schedules import ByVisits, epsilon, learning_rate
from qtab.results.rates import rates_of
from qtab.results.run import Run

POINTS = 1000
"""The largest number of episodes, evenly spaced, at which a rate is computed."""


def learning_rates(run: Run) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Returns (n,) evenly spaced episodes, the last one included, and (n,) learning rates; by visits the first one."""
    points, rate = _evenly_spaced(len(run.episode_returns)), learning_rate(run.config)
    if isinstance(rate, ByVisits):
        return points, np.full(len(points), rate.value)
    return points, rates_of(run, rate, points)


def epsilons(run: Run) -> NDArray[np.float64]:
    """Returns (n,): the exploration rate of an epsilon-greedy policy in evenly spaced episodes, the last included."""
    return rates_of(run, epsilon(run.config), _evenly_spaced(len(run.episode_returns)))


def _evenly_spaced(episodes: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, episodes - 1, min(episodes, POINTS)).astype(np.int64))
