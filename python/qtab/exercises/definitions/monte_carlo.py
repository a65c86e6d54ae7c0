"""Exercise 5: first-visit Monte Carlo control."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.exercise import Exercise
from qtab.exercises.learner_check import LearnerCheck
from qtab.exercises.parts import NONE, POLICY, Mistakes, epsilon_greedy

STARTER = '''\
import numpy as np


def monte_carlo(env, q, episodes, discount, epsilon, rng):
    """Learn by first-visit Monte Carlo control: change q in place after each episode.

    Choose the actions of an episode with q as it is before the episode. After it, go
    through its steps from last to first: G = reward + discount * G, where G is 0.0
    after the last step. If it is the first visit of this state and action in the
    episode, and their n-th first visit in all episodes:
    q[state, action] += 1 / n * (G - q[state, action]).

    env: call env.reset() and env.step(action); all episodes end in a terminal state.
    q: the action values, of shape (states, actions).
    episodes: the number of episodes.
    rng: the generator for your epsilon_greedy(values, epsilon, rng) of exercise 1.
    """
'''


def monte_carlo(
    env: Any,
    q: NDArray[np.float64],
    episodes: int,
    discount: float,
    epsilon: float,
    rng: np.random.Generator,
    wrong: Mistakes = NONE,
) -> None:
    """Learns from the returns of whole episodes."""
    counts = np.zeros(q.shape, dtype=int)
    for _ in range(episodes):
        state, _ = env.reset()
        pairs: list[tuple[int, int]] = []
        rewards: list[float] = []
        over = False
        while not over:
            action = epsilon_greedy(q[state], epsilon, rng, wrong)
            pairs.append((state, action))
            state, reward, terminated, truncated, _ = env.step(action)
            rewards.append(float(reward))
            over = terminated or truncated
        G = 0.0  # noqa: N806 - the book's name
        for t in reversed(range(len(pairs))):
            late = G
            G = rewards[t] + (1.0 if "no_discount" in wrong else discount) * G  # noqa: N806
            if "every_visit" in wrong or pairs[t] not in (pairs[t + 1 :] if "last_visit" in wrong else pairs[:t]):
                target = late if "late_reward" in wrong else G
                counts[pairs[t]] += 1
                if "rounding" in wrong:
                    q[pairs[t]] += (target - q[pairs[t]]) / counts[pairs[t]]
                else:
                    q[pairs[t]] += 1 / counts[pairs[t]] * (target - q[pairs[t]])


def _check(title: str, episodes: int, discount: float, epsilon: float, spread: float, seed: int) -> LearnerCheck:
    settings = {"discount": discount, "epsilon": epsilon}
    return LearnerCheck(title, monte_carlo, "FrozenLake-v1", episodes, 5000, settings, "q", spread, seed)


EXERCISE = Exercise(
    number=5,
    name="monte_carlo",
    title="First-visit Monte Carlo control",
    section="5.4",
    starter=STARTER,
    model=monte_carlo,
    mistakes=("every_visit", "last_visit", "late_reward", "no_discount", "rounding", *POLICY),
    checks=[
        _check("FrozenLake-v1, 1 episode", 1, 0.9, 0.5, 1.0, 6),
        _check("FrozenLake-v1, 100 episodes from zeros", 100, 0.9, 0.9, 0.0, 4),
        _check("FrozenLake-v1, 60 episodes from random values", 60, 0.95, 0.2, 1.0, 5),
    ],
)
