"""Exercise 8: Q-learning."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.definitions.control_checks import control_checks
from qtab.exercises.exercise import Exercise
from qtab.exercises.parts import (
    NONE,
    POLICY,
    STEPS,
    UPDATE,
    Mistakes,
    epsilon_greedy,
    move,
    nothing_follows,
    rates,
    state_after,
    stops_before_update,
)

STARTER = '''\
import numpy as np


def q_learning(env, q, episodes, learning_rate, discount, epsilon, rng):
    """Learn by Q-learning: change q in place after each step.

    Choose an action, take it, and update:
    target = reward + discount * the largest value of the next state,
    q[state, action] += learning_rate * (target - q[state, action]).
    If the next state is terminal (terminated), the target is the reward; at a
    time-out (truncated) it is the same as after any other step.

    env: call env.reset() and env.step(action).
    q: the action values, of shape (states, actions).
    rng: the generator for your epsilon_greedy(values, epsilon, rng) of exercise 1.
    """
'''


def q_learning(
    env: Any,
    q: NDArray[np.float64],
    episodes: int,
    learning_rate: float,
    discount: float,
    epsilon: float,
    rng: np.random.Generator,
    wrong: Mistakes = NONE,
) -> None:
    """Learns from the best next action."""
    learning_rate, discount = rates(learning_rate, discount, wrong)
    for _ in range(episodes):
        state, _ = env.reset()
        over, action = False, -1
        if "early_choice" in wrong:
            action = epsilon_greedy(q[state], epsilon, rng, wrong)
        while not over:
            if "early_choice" not in wrong:
                action = epsilon_greedy(q[state], epsilon, rng, wrong)
            next_state, reward, terminated, truncated, _ = env.step(action)
            over = terminated or truncated
            if stops_before_update(over, wrong):
                break
            ended = nothing_follows(terminated, truncated, wrong)
            target, next_action = reward, -1
            if "early_choice" in wrong and not ended:
                next_action = epsilon_greedy(q[next_state], epsilon, rng, wrong)
            if not ended:
                target = reward + discount * _following(q, state, next_state, epsilon, rng, wrong)
            move(q, (state, action), learning_rate, target, wrong)
            state, action = state_after(state, next_state, wrong), next_action


def _following(
    q: NDArray[np.float64], state: int, next_state: int, epsilon: float, rng: np.random.Generator, wrong: Mistakes
) -> float:
    if "max_of_old_state" in wrong:
        return float(q[state].max())
    if "max_of_table" in wrong:
        return float(q.max())
    if "argmax" in wrong:
        return float(np.argmax(q[next_state]))
    if "sampled_action" in wrong:
        return float(q[next_state, epsilon_greedy(q[next_state], epsilon, rng, wrong)])
    return float(q[next_state].max())


EXERCISE = Exercise(
    number=8,
    name="q_learning",
    title="Q-learning",
    section="6.5",
    starter=STARTER,
    model=q_learning,
    mistakes=("max_of_old_state", "max_of_table", "argmax", "sampled_action", "early_choice", *STEPS, *UPDATE, *POLICY),
    checks=control_checks(q_learning),
)
