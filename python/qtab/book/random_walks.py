"""The random walks of the book's figures, and what is measured of estimates on them."""

from functools import cache

import gymnasium as gym
import numpy as np

from qtab.book.prediction_experiment import Measure, PredictionSetting, PredictionTask
from qtab.book.runner import FloatArray
from qtab.planning.policy_values import PolicyValues, policy_values
from qtab.prediction.estimates import ValueEstimates

EPISODES = 10
"""The episodes over which the figures of chapters 7, 9 and 12 average errors."""
ALPHAS = (0.0, 0.01, 0.02, 0.04, 0.06, 0.08, *(round(0.1 + 0.05 * step, 2) for step in range(19)))
"""The learning rates of those figures, from 0 to 1."""
TRACE_DECAYS = (0.0, 0.4, 0.8, 0.9, 0.95, 0.975, 0.99, 1.0)
"""λ in the figures of chapter 12."""
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


def mean_rms_error(estimates: ValueEstimates, truth: PolicyValues) -> FloatArray:
    """Returns (runs, 1): the RMS error over the states, averaged over the recorded episodes."""
    return estimates.rms_error(truth).mean(axis=1, keepdims=True)


def rms_errors(estimates: ValueEstimates, truth: PolicyValues) -> FloatArray:
    """Returns (runs, points): the RMS error over the states after each recorded episode."""
    return estimates.rms_error(truth)


def root_value_error(estimates: ValueEstimates, truth: PolicyValues) -> FloatArray:
    """Returns (runs, points): the root of VE (equation 9.1), which weights states by how often they are visited."""
    return estimates.rms_error(truth, truth.state_distribution)


def values_at(point: int) -> Measure:
    """Returns a measure: (runs, states), the values at a recorded point."""

    def values(estimates: ValueEstimates, truth: PolicyValues) -> FloatArray:  # noqa: ARG001 - as other measures
        return estimates.values_after(point)

    return values


def true_values(estimates: ValueEstimates, truth: PolicyValues) -> FloatArray:
    """Returns (runs, states): the exact values in every run."""
    return np.broadcast_to(truth.values, (len(estimates.seeds), *truth.values.shape))


def by_trace_decay_and_rate(method: str) -> tuple[PredictionSetting, ...]:
    """Returns the settings of a figure of chapter 12: each λ with each α on the walk of 19 states."""
    return tuple(
        PredictionSetting(
            f"λ = {trace_decay:g}",
            nineteen_states,
            {"method": method, "trace_decay": trace_decay, "learning_rate": alpha, "episodes": EPISODES},
            mean_rms_error,
            (alpha,),
        )
        for trace_decay in TRACE_DECAYS
        for alpha in ALPHAS
    )
