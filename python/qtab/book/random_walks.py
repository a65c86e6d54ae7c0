"""The random walks of the book's figures, and measures of estimates on them."""

from functools import cache

import gymnasium as gym
import numpy as np

from qtab.book.prediction_experiment import Measure, PredictionTask
from qtab.book.runner import FloatArray
from qtab.planning.policy_values import PolicyValues, policy_values
from qtab.prediction.estimates import ValueEstimates

EPISODES = 10
"""The episodes over which the figures of chapters 7, 9 and 12 average errors."""
ALPHAS = (0.0, 0.01, 0.02, 0.04, 0.06, 0.08, *(round(0.1 + 0.05 * step, 2) for step in range(19)))
"""The learning rates of those figures, from 0 to 1."""
TOP = 0.55
"""The highest error that those figures show."""


@cache
def _walk(states: int, reach: int, left_reward: float) -> PredictionTask:
    env = gym.make("qtab/RandomWalk-v0", states=states, reach=reach, left_reward=left_reward)
    return PredictionTask(env, "random", policy_values(env, "random"))


def five_states() -> PredictionTask:
    """Returns the walk of Example 6.2: rewards of 0 on the left and 1 on the right."""
    return _walk(5, 1, 0.0)


def nineteen_states() -> PredictionTask:
    """Returns the walk of Example 7.1: rewards of -1 on the left and 1 on the right."""
    return _walk(19, 1, -1.0)


def thousand_states() -> PredictionTask:
    """Returns the walk of Example 9.1: steps to any of the 100 neighbors on a side."""
    return _walk(1000, 100, -1.0)


def mean_rms_error(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:
    """Returns (runs, 1): the RMS error over the states, averaged over the recorded episodes."""
    errors: FloatArray = estimates.rms_error(true_values).mean(axis=1, keepdims=True)
    return errors


def rms_errors(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:
    """Returns (runs, points): the RMS error over the states after each recorded episode."""
    return estimates.rms_error(true_values)


def root_value_error(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:
    """Returns (runs, points): the root of VE (equation 9.1), which weights states by how often they are visited."""
    return estimates.rms_error(true_values, true_values.state_distribution)


def values_at(point: int) -> Measure:
    """Returns a measure: (runs, states), the values at a recorded point."""

    def values(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:  # noqa: ARG001 - as other measures
        return estimates.values_after(point)

    return values


def exact_values(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:
    """Returns (runs, states): the exact values, repeated for every run."""
    return np.broadcast_to(true_values.values, (len(estimates.seeds), *true_values.values.shape))
