"""Exercise 11: Dyna-Q."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.definitions.control_checks import control_checks
from qtab.exercises.exercise import Exercise
from qtab.exercises.parts import NONE, POLICY, UPDATE, Mistakes, epsilon_greedy, move, nothing_follows, rates

STARTER = '''\
import numpy as np


def dyna_q(env, q, episodes, planning_steps, learning_rate, discount, epsilon, rng):
    """Learn by Dyna-Q: change q in place.

    After each step: the update of Q-learning; then store the reward and the next
    state for this state and action, or that nothing follows if it is terminal
    (terminated); then planning_steps updates of Q-learning with stored outcomes. For
    each draw a state among the m visited ones, in the order of their first visits,
    with rng.integers(m), and then one of the k actions tried there, in the order of
    their first tries, with rng.integers(k). (A dict of dicts keeps these orders.)
    Only the last outcome of a state and action is stored.

    env: call env.reset() and env.step(action).
    q: the action values, of shape (states, actions).
    planning_steps: the number of planning updates after a step.
    rng: the generator for your epsilon_greedy(values, epsilon, rng) of exercise 1.
    """
'''

Model = dict[int, dict[int, tuple[float, int | None]]]
"""The last reward and next state of each state and action; None after a terminal state."""


def dyna_q(
    env: Any,
    q: NDArray[np.float64],
    episodes: int,
    planning_steps: int,
    learning_rate: float,
    discount: float,
    epsilon: float,
    rng: np.random.Generator,
    wrong: Mistakes = NONE,
) -> None:
    """Learns from steps, and from remembered ones."""
    rate, discount = rates(learning_rate, discount, wrong)
    model: Model = {}
    pairs: list[tuple[int, int]] = []  # in the order of their first tries

    def learn(state: int, action: int, reward: float, next_state: int | None) -> None:
        target = reward if next_state is None else reward + discount * q[next_state].max()
        move(q, (state, action), rate, target, wrong)

    def plan() -> None:
        for _ in range(0 if "no_planning" in wrong else planning_steps):
            if not model:
                return
            if "plans_over_pairs" in wrong:
                state, action = pairs[int(rng.integers(len(pairs)))]
            elif "plans_over_pairs_by_state" in wrong:
                by_state = [(state, action) for state, tried in model.items() for action in tried]
                state, action = by_state[int(rng.integers(len(by_state)))]
            else:
                state = list(model)[int(rng.integers(len(model)))]
                action = list(model[state])[int(rng.integers(len(model[state])))]
            learn(state, action, *model[state][action])

    for _ in range(episodes):
        state, _ = env.reset()
        over = False
        while not over:
            action = epsilon_greedy(q[state], epsilon, rng, wrong)
            next_state, reward, terminated, truncated, _ = env.step(action)
            over = terminated or truncated
            after = None if nothing_follows(terminated, truncated, wrong) else next_state
            learn(state, action, float(reward), after)
            if "model_after_planning" in wrong:
                plan()
            if action not in model.setdefault(state, {}):
                pairs.append((state, action))
            model[state][action] = float(reward), after
            if "model_after_planning" not in wrong:
                plan()
            state = next_state


EXERCISE = Exercise(
    number=11,
    name="dyna_q",
    title="Dyna-Q",
    section="8.2",
    starter=STARTER,
    model=dyna_q,
    mistakes=(
        *("no_planning", "plans_over_pairs", "plans_over_pairs_by_state", "model_after_planning"),
        *(*UPDATE, *POLICY),
    ),
    checks=control_checks(dyna_q, planning_steps=(3, 1, 5)),
)
