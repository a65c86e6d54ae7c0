"""The exploration rate and the learning rate over the episodes of a run."""

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.schedules import ByVisits, epsilon, learning_rate, rates

POINTS = 1000
"""The largest number of episodes, evenly spaced, at which a rate is computed."""


def learning_rates(config: Config, episodes: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Returns (n,) evenly spaced episodes, the last one included, and (n,) learning rates; by visits the first one."""
    points, rate = _evenly_spaced(episodes), learning_rate(config)
    if isinstance(rate, ByVisits):
        return points, np.full(len(points), rate.value)
    return points, rates(rate, points, config.episodes)


def epsilons(config: Config, episodes: int) -> NDArray[np.float64]:
    """Returns (n,): the exploration rate of an epsilon-greedy policy in evenly spaced episodes, the last included."""
    return rates(epsilon(config), _evenly_spaced(episodes), config.episodes)


def _evenly_spaced(episodes: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, episodes - 1, min(episodes, POINTS)).astype(np.int64))
