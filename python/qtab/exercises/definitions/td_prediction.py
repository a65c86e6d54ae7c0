"""Exercise 6: TD(0), the values of a policy."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.exercise import Exercise
from qtab.exercises.learner_check import PredictionCheck
from qtab.exercises.parts import (
    NONE,
    STEPS,
    UPDATE,
    Mistakes,
    move,
    nothing_follows,
    rates,
    state_after,
    stops_before_update,
)

STARTER = '''\
import numpy as np


def td_prediction(env, values, policy, episodes, learning_rate, discount):
    """Estimate the values of a policy by TD(0): change values in place.

    After each step:
    target = reward + discount * values[next_state],
    values[state] += learning_rate * (target - values[state]).
    If the next state is terminal (terminated), the target is the reward. An episode
    ends if it is terminated or truncated.

    env: call env.reset() and env.step(action).
    values: the estimate of each state, of shape (states,).
    policy: the action in each state, of shape (states,).
    """
'''


def td_prediction(
    env: Any,
    values: NDArray[np.float64],
    policy: NDArray[np.int64],
    episodes: int,
    learning_rate: float,
    discount: float,
    wrong: Mistakes = NONE,
) -> None:
    """Estimates the values of a policy."""
    learning_rate, discount = rates(learning_rate, discount, wrong)
    for _ in range(episodes):
        state, _ = env.reset()
        over = False
        while not over:
            next_state, reward, terminated, truncated, _ = env.step(int(policy[state]))
            over = terminated or truncated
            if stops_before_update(over, wrong):
                break
            following = values[state if "value_of_old_state" in wrong else next_state]
            target = reward if nothing_follows(terminated, truncated, wrong) else reward + discount * following
            move(values, state, learning_rate, target, wrong)
            state = state_after(state, next_state, wrong)


def _check(
    title: str, env_id: str, episodes: int, steps: int, spread: float, learning_rate: float, discount: float
) -> PredictionCheck:
    settings = {"learning_rate": learning_rate, "discount": discount}
    return PredictionCheck(title, td_prediction, env_id, episodes, steps, settings, spread=spread, seed=1)


EXERCISE = Exercise(
    number=6,
    name="td_prediction",
    title="TD(0)",
    section="6.1",
    starter=STARTER,
    model=td_prediction,
    mistakes=("value_of_old_state", *STEPS, *UPDATE),
    checks=[
        _check("CliffWalking-v1, 5 episodes of at most 30 steps from zeros", "CliffWalking-v1", 5, 30, 0.0, 0.2, 0.9),
        _check("FrozenLake-v1, 20 episodes from random values", "FrozenLake-v1", 20, 1000, 1.0, 0.5, 0.8),
        _check("FrozenLake-v1, 20 episodes of at most 4 steps", "FrozenLake-v1", 20, 4, 1.0, 0.1, 1.0),
    ],
)
