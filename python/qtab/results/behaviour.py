"""The behaviour policy of a run, with the exploration at the end of its training."""

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.schedules import EpsilonGreedy, Ucb, policy


def action_probabilities(config: Config, episodes: int, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (n, actions): the probability of each action after ``episodes`` episodes.

    Args:
        config: The config of a run.
        episodes: The number of finished episodes, which determines ε.
        values: (n, actions): the action values, -inf for unavailable actions; each row has an available action.
    """
    chosen = policy(config)
    if isinstance(chosen, EpsilonGreedy):
        epsilon = chosen.epsilon.after(episodes, config.episodes)
        greedy = _greedy(values, chosen.ties == "random")
        return epsilon * _uniform(~np.isneginf(values)) + (1.0 - epsilon) * _uniform(greedy)
    if isinstance(chosen, Ucb):  # a run does not hold the action counts that UCB needs
        return _uniform(_greedy(values, chosen.ties == "random"))
    with np.errstate(under="ignore"):
        weights = np.exp((values - values.max(axis=1, keepdims=True)) / chosen.temperature)
    probabilities: NDArray[np.float64] = weights / weights.sum(axis=1, keepdims=True)
    return probabilities


def sample(probabilities: NDArray[np.float64], generator: np.random.Generator) -> NDArray[np.int64]:
    """Returns (n,): an action drawn from each row of (n, actions) probabilities."""
    cumulative = np.cumsum(probabilities, axis=1)
    total = cumulative[:, -1:]
    # After rounding, a draw may equal the total; the last actions may have probability 0.
    drawn = np.minimum(generator.random(total.shape) * total, np.nextafter(total, 0.0))
    actions: NDArray[np.int64] = np.argmax(drawn < cumulative, axis=1)
    return actions


def _greedy(values: NDArray[np.float64], all_of_them: bool) -> NDArray[np.bool_]:
    greedy: NDArray[np.bool_] = values == values.max(axis=1, keepdims=True)
    if not all_of_them:
        greedy = np.arange(values.shape[1]) == np.argmax(values, axis=1)[:, np.newaxis]
    return greedy


def _uniform(chosen: NDArray[np.bool_]) -> NDArray[np.float64]:
    shares: NDArray[np.float64] = chosen / chosen.sum(axis=1, keepdims=True)
    return shares
