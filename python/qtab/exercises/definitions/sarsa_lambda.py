"""Exercise 12: Sarsa(lambda) with linear function approximation."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.exercise import Exercise
from qtab.exercises.learner_check import FeatureCheck
from qtab.exercises.parts import NONE, POLICY, UPDATE, Mistakes, epsilon_greedy, nothing_follows, rates

STARTER = '''\
import numpy as np


def sarsa_lambda(env, features, w, episodes, learning_rate, discount, trace_decay, epsilon, rng):
    """Learn by Sarsa(lambda) with accumulating traces: change w in place.

    The values of an observation are w[rows].sum(axis=0), of shape (actions,), where
    rows = features(observation). The traces z have the shape of w and are 0 at the
    start of an episode. After each step: add 1 to z[rows, action] of the old
    observation, choose the next action in the next one, and then update:
    error = reward + discount * next value of the next action - value of the action,
    w += learning_rate / len(rows) * error * z (from left to right),
    z *= discount * trace_decay.
    If the next state is terminal (terminated), no action is chosen, and the next
    value is left out.

    env: call env.reset() and env.step(action).
    features: a function from an observation to its active rows, an array of integers.
    w: the weights, of shape (rows, actions).
    rng: the generator for your epsilon_greedy(values, epsilon, rng) of exercise 1.
    """
'''


def sarsa_lambda(
    env: Any,
    features: Callable[[Any], NDArray[np.int64]],
    w: NDArray[np.float64],
    episodes: int,
    learning_rate: float,
    discount: float,
    trace_decay: float,
    epsilon: float,
    rng: np.random.Generator,
    wrong: Mistakes = NONE,
) -> None:
    """Learns with eligibility traces."""
    rate, discount = rates(learning_rate, discount, wrong)
    z = np.zeros_like(w)
    for _ in range(episodes):
        observation, _ = env.reset()
        rows = features(observation)
        if "traces_kept" not in wrong:
            z[:] = 0.0
        action = epsilon_greedy(w[rows].sum(axis=0), epsilon, rng, wrong)
        over = False
        while not over:
            observation, reward, terminated, truncated, _ = env.step(action)
            over = terminated or truncated
            if "replacing_traces" in wrong:
                z[rows, action] = 1.0
            else:
                z[rows, action] += 1.0
            if "early_decay" in wrong:
                z *= discount * trace_decay
            next_rows, next_action, target = features(observation), action, float(reward)
            if not nothing_follows(terminated, truncated, wrong):
                values = w[next_rows].sum(axis=0)
                next_action = epsilon_greedy(values, epsilon, rng, wrong)
                following = values[action if "old_action" in wrong else next_action]
                if "max_in_sarsa" in wrong:
                    following = values.max()
                target = reward + discount * following
            error = target - (0.0 if "no_old_value" in wrong else w[rows].sum(axis=0)[action])
            w += (rate if "not_divided" in wrong else rate / len(rows)) * error * z
            if "early_decay" not in wrong:
                z *= trace_decay if "decay_without_discount" in wrong else discount * trace_decay
            rows, action = next_rows, next_action


def _check(title: str, episodes: int, steps: int, values: Sequence[float], spread: float) -> FeatureCheck:
    settings = dict(zip(("learning_rate", "discount", "trace_decay", "epsilon"), values, strict=True))
    return FeatureCheck(title, sarsa_lambda, "CartPole-v1", episodes, steps, settings, spread=spread, seed=2)


EXERCISE = Exercise(
    number=12,
    name="sarsa_lambda",
    title="Sarsa(lambda) on tile coding",
    section="12.7",
    starter=STARTER,
    model=sarsa_lambda,
    mistakes=(
        "old_action",
        "max_in_sarsa",
        "replacing_traces",
        "traces_kept",
        "early_decay",
        "decay_without_discount",
        "not_divided",
        *(key for key in UPDATE if key != "rounding"),
        *POLICY,
    ),
    checks=[
        _check("CartPole-v1 from zeros without exploring, 6 episodes", 6, 100, (0.2, 0.9, 0.8, 0.0), 0.0),
        _check("CartPole-v1 from random weights, 5 episodes", 5, 100, (0.1, 0.95, 0.6, 0.2), 0.1),
        _check("CartPole-v1, 8 episodes of at most 8 steps", 8, 8, (0.3, 0.8, 0.9, 0.3), 0.1),
    ],
)
