"""The problems that several of the book's figures share, with their settings and measures."""

from functools import cache
from typing import Any

import gymnasium as gym
import numpy as np

from qtab import _core
from qtab.book.prediction_experiment import Measure, PredictionTask
from qtab.book.runner import FloatArray
from qtab.envs.in_rust.native import table_env
from qtab.envs.tabular import TabularEnv
from qtab.planning.policy_values import PolicyValues, policy_values
from qtab.prediction.estimates import ValueEstimates

ENV = "MountainCar-v0"
"""Gymnasium's environment: the book's dynamics, a reward of -1 per step, the goal at 0.5."""

TILE_CODING: dict[str, Any] = {
    "discretizer": "tiles",
    "tilings": 8,
    "tiles": 8,
    "low": (-1.2, -0.07),
    "high": (0.5, 0.07),
    "discount": 1.0,
    "epsilon": 0.0,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
}
"""8 tilings of 8 x 8 tiles with asymmetric offsets. Initial values of zero are optimistic, so ε = 0 explores enough."""

UNSPECIFIED = (
    "how ties are broken (at random here), and what happens to an episode that does not end (truncated here). The "
    "book hashes its tiles; here they are not hashed"
)
"""The settings that the book states for none of these experiments."""


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


STATE = (13, 2, 1)
"""The state of Figure 5.3: a sum of 13 with a usable ace, and the dealer shows a two."""
_SHAPE = (32, 11, 2)


def sticks_on_20(observation: tuple[int, int, int]) -> int:
    """Returns the action of the book's policy: it sticks (0) on 20 and 21 and hits (1) otherwise."""
    return int(observation[0] < 20)


@cache
def blackjack() -> PredictionTask:
    """Returns the game by the book's rules with that policy."""
    env = gym.make("Blackjack-v1", sab=True)
    return PredictionTask(env, sticks_on_20, policy_values(env, sticks_on_20))


@cache
def single_state() -> PredictionTask:
    """Returns the game whose episodes begin in the state of Figure 5.3, as a table of its rules."""
    solver = _core.MdpSolver(table_env(gym.make("Blackjack-v1", sab=True).unwrapped))
    pairs, states = solver.transitions(), len(solver.rows)
    start = index_of(STATE)
    env = TabularEnv(
        [pairs[2 * state : 2 * state + 2] for state in range(states)],
        [float(state == start) for state in range(states)],
    )

    def policy(state: int) -> int:
        # Naturals, which have a sum of 21, come after the states that observations show.
        total = state // (_SHAPE[1] * _SHAPE[2])
        return int(total < 20 and state < _SHAPE[0] * _SHAPE[1] * _SHAPE[2])

    return PredictionTask(env, policy, policy_values(env, policy))


def index_of(observation: Any) -> int:
    """Returns the state of an observation in the table."""
    total, shown, ace = observation
    return int((total * _SHAPE[1] + shown) * _SHAPE[2] + ace)
