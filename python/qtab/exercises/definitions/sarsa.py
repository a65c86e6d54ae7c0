"""Exercise 7: Sarsa."""

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


def sarsa(env, q, episodes, learning_rate, discount, epsilon, rng):
    """Learn by Sarsa: change q in place after each step.

    Choose the first action of an episode after env.reset(). After each step choose
    the next action in the next state, and then update:
    target = reward + discount * q[next_state, next_action],
    q[state, action] += learning_rate * (target - q[state, action]).
    If the next state is terminal (terminated), the target is the reward, and no
    action is chosen. At a time-out (truncated) the next action is chosen for the
    target, though not taken.

    env: call env.reset() and env.step(action).
    q: the action values, of shape (states, actions).
    rng: the generator for your epsilon_greedy(values, epsilon, rng) of exercise 1.
    """
'''


def sarsa(
    env: Any,
    q: NDArray[np.float64],
    episodes: int,
    learning_rate: float,
    discount: float,
    epsilon: float,
    rng: np.random.Generator,
    wrong: Mistakes = NONE,
) -> None:
    """Learns from the next action."""
    learning_rate, discount = rates(learning_rate, discount, wrong)
    for _ in range(episodes):
        state, _ = env.reset()
        action = epsilon_greedy(q[state], epsilon, rng, wrong)
        over = False
        while not over:
            next_state, reward, terminated, truncated, _ = env.step(action)
            over = terminated or truncated
            if stops_before_update(over, wrong):
                break
            next_action, target = action, reward
            ended = nothing_follows(terminated, truncated, wrong)
            if (not ended or "draws_at_end" in wrong) and "q_learning" not in wrong:
                next_action = epsilon_greedy(q[next_state], epsilon, rng, wrong)
            if not ended:
                following = q[next_state, next_action]
                if "old_action" in wrong:
                    following = q[next_state, action]
                elif "max_in_sarsa" in wrong or "q_learning" in wrong:
                    following = q[next_state].max()
                elif "value_of_old_state" in wrong:
                    following = q[state, next_action]
                target = reward + discount * following
            move(q, (state, action), learning_rate, target, wrong)
            if ("draws_again" in wrong or "q_learning" in wrong) and not over:
                next_action = epsilon_greedy(q[next_state], epsilon, rng, wrong)
            state, action = state_after(state, next_state, wrong), next_action


EXERCISE = Exercise(
    number=7,
    name="sarsa",
    title="Sarsa",
    section="6.4",
    starter=STARTER,
    model=sarsa,
    mistakes=(
        *("old_action", "max_in_sarsa", "q_learning", "value_of_old_state", "draws_again", "draws_at_end"),
        *(*STEPS, *UPDATE, *POLICY),
    ),
    checks=control_checks(sarsa),
)
