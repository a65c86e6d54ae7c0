"""Exercise 10: n-step Sarsa."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.definitions.control_checks import control_checks
from qtab.exercises.exercise import Exercise
from qtab.exercises.parts import NONE, POLICY, UPDATE, Mistakes, epsilon_greedy, move, nothing_follows, rates

STARTER = '''\
import numpy as np


def n_step_sarsa(env, q, episodes, n, learning_rate, discount, epsilon, rng):
    """Learn by n-step Sarsa: change q in place.

    A step waits until n rewards are known, its own included, or the episode has
    ended. After each step of the environment choose the next action in the next state
    (unless it is terminal), and then update the step that has waited for n rewards.
    After the end update all waiting steps, from first to last. The target of a step
    is R1 + discount * R2 + discount**2 * R3 + ..., added in this order from 0.0 with
    a factor that starts at 1.0 and is multiplied by discount after each reward; then
    factor * q[last state, last action], unless the last state is terminal
    (terminated). The update itself is that of Sarsa, exercise 7.

    env: call env.reset() and env.step(action).
    q: the action values, of shape (states, actions).
    n: the number of rewards in a target, at least 1.
    rng: the generator for your epsilon_greedy(values, epsilon, rng) of exercise 1.
    """
'''


def n_step_sarsa(
    env: Any,
    q: NDArray[np.float64],
    episodes: int,
    n: int,
    learning_rate: float,
    discount: float,
    epsilon: float,
    rng: np.random.Generator,
    wrong: Mistakes = NONE,
) -> None:
    """Learns from the rewards of n steps."""
    learning_rate, discount = rates(learning_rate, discount, wrong)
    n += "one_step_more" in wrong
    for _ in range(episodes):
        state, _ = env.reset()
        action = epsilon_greedy(q[state], epsilon, rng, wrong)
        waiting: list[tuple[int, int, float]] = []
        over = ended = truncated = False
        while waiting or not over:
            if not over:
                next_state, reward, terminated, truncated, _ = env.step(action)
                over, ended = terminated or truncated, nothing_follows(terminated, truncated, wrong)
                waiting.append((state, action, float(reward)))
                state = next_state
                if not ended:
                    action = epsilon_greedy(q[state], epsilon, rng, wrong)
            if over and "end_not_flushed" in wrong and len(waiting) < n:
                break
            if over or len(waiting) == n:
                target, factor = 0.0, 1.0
                for _, _, later in waiting:
                    target += factor * later
                    factor *= discount
                if not ended and not (over and truncated and "no_value_at_time_out" in wrong):
                    target += (discount if "discount_once" in wrong else factor) * q[state, action]
                past_state, past_action, _ = waiting.pop(0)
                move(q, (past_state, past_action), learning_rate, target, wrong)


EXERCISE = Exercise(
    number=10,
    name="n_step_sarsa",
    title="n-step Sarsa",
    section="7.2",
    starter=STARTER,
    model=n_step_sarsa,
    mistakes=("one_step_more", "discount_once", "end_not_flushed", "no_value_at_time_out", *UPDATE, *POLICY),
    checks=control_checks(n_step_sarsa, n=(3, 1, 8)),
)
