"""The exploration rate and the learning rate over the episodes of a run."""

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config

POINTS = 1000
"""So many episodes, evenly spaced, stand for all."""


def learning_rates(config: Config, episodes: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Returns evenly spaced episodes, the last one included, and the learning rate in each."""
    return _rates(
        config.learning_rate_schedule,
        config.learning_rate,
        config.min_learning_rate or 0.0,
        config.learning_rate_decay,
        config.learning_rate_warm_up or 0,
        config.episodes,
        episodes,
    )


def epsilons(config: Config, episodes: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Returns evenly spaced episodes, the last one included, and the exploration rate in each."""
    return _rates(
        config.epsilon_schedule or "constant",
        config.epsilon or 0.0,
        config.min_epsilon or 0.0,
        config.epsilon_decay,
        config.epsilon_warm_up or 0,
        config.episodes,
        episodes,
    )


def _rates(
    kind: str, first: float, least: float, decay: float | None, warm_up: int, total: int, episodes: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    points = np.unique(np.linspace(0, episodes - 1, min(episodes, POINTS)).astype(np.int64))
    falls = np.maximum(points - warm_up, 0)
    if kind == "linear":
        rates = np.maximum(first - falls * ((first - least) / max(total - warm_up, 1)), least)
    elif kind == "exponential" and decay is not None:
        rates = np.maximum(first * decay ** falls.astype(np.float64), least)
    else:
        rates = np.full(len(points), first)
    return points, rates
