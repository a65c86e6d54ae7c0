"""Exercise 9: Expected Sarsa."""

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


def expected_sarsa(env, q, episodes, learning_rate, discount, epsilon, rng):
    """Learn by Expected Sarsa: change q in place after each step.

    Like Q-learning, but with the expected value of the next state under the
    epsilon-greedy policy:
    target = reward + discount * np.sum(p * q[next_state]),
    where p is epsilon / n for each of the n actions, and 1 - epsilon is added to that
    of the first action with the largest value. If the next state is terminal
    (terminated), the target is the reward.

    env: call env.reset() and env.step(action).
    q: the action values, of shape (states, actions).
    rng: the generator for your epsilon_greedy(values, epsilon, rng) of exercise 1.
    """
'''


def expected_sarsa(
    env: Any,
    q: NDArray[np.float64],
    episodes: int,
    learning_rate: float,
    discount: float,
    epsilon: float,
    rng: np.random.Generator,
    wrong: Mistakes = NONE,
) -> None:
    """Learns from the expected value of the next action."""
    learning_rate, discount = rates(learning_rate, discount, wrong)
    for _ in range(episodes):
        state, _ = env.reset()
        over = False
        while not over:
            action = epsilon_greedy(q[state], epsilon, rng, wrong)
            next_state, reward, terminated, truncated, _ = env.step(action)
            over = terminated or truncated
            if stops_before_update(over, wrong):
                break
            target = reward
            if not nothing_follows(terminated, truncated, wrong):
                p = _probabilities(q[state if "old_policy" in wrong else next_state], epsilon, wrong)
                values = q[state if "value_of_old_state" in wrong else next_state]
                following = values.max() if "greedy_policy" in wrong else np.sum(p * values)
                target = reward + discount * following
            move(q, (state, action), learning_rate, target, wrong)
            state = state_after(state, next_state, wrong)


def _probabilities(values: NDArray[np.float64], epsilon: float, wrong: Mistakes) -> NDArray[np.float64]:
    n = len(values)
    if "uniform_policy" in wrong:
        return np.full(n, 1 / n)
    if "greedy_share" in wrong:
        p = np.full(n, epsilon / (n - 1))
        p[np.argmax(values)] = 1 - epsilon
        return p
    p = np.full(n, epsilon / n)
    p[np.argmax(values)] += 1.0 - epsilon
    return p


EXERCISE = Exercise(
    number=9,
    name="expected_sarsa",
    title="Expected Sarsa",
    section="6.6",
    starter=STARTER,
    model=expected_sarsa,
    mistakes=(
        *("greedy_share", "uniform_policy", "greedy_policy", "old_policy", "value_of_old_state"),
        *(*STEPS, *UPDATE, *POLICY),
    ),
    checks=control_checks(expected_sarsa),
)
