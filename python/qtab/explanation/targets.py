"""What a target is made of: rewards, and the value of the next state as each algorithm takes it."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from qtab.reference.action_masks import ActionMasks
from qtab.reference.policies import Policy
from qtab.reference.task import value, values

Table = NDArray[np.float64]


def bootstrap(
    algorithm: str,
    tables: Sequence[Table],
    table: int,
    next_state: list[int],
    next_action: int,
    policy: Policy,
    masks: ActionMasks,
) -> float:
    """Returns the value of a next state that is not terminal.

    Args:
        algorithm: The algorithm.
        tables: The tables: two for Double Q-learning.
        table: The index of the one that learns.
        next_state: The active rows of the next state.
        next_action: The next action, for algorithms that learn from it.
        policy: The policy, for Expected Sarsa.
        masks: Which actions the states have.
    """
    Q = tables[table]  # noqa: N806 - the book's name
    if algorithm in ("sarsa", "n_step_sarsa", "sarsa_lambda", "true_online_sarsa_lambda"):
        return value(Q, next_state, next_action)
    next_values = masks.masked(next_state, values(Q, next_state))
    if algorithm == "double_q_learning":
        return value(tables[1 - table], next_state, int(np.argmax(next_values)))
    if algorithm == "expected_sarsa":
        return _expected(policy.probabilities(next_values, next_state), next_values)
    return float(np.max(next_values))


def discounted(rewards: Sequence[float], discount: float, following: float | None) -> float:
    """Returns the target: the discounted rewards and the value of what follows, added from left to right."""
    if len(rewards) == 1:
        return rewards[0] if following is None else rewards[0] + discount * following
    target, factor = 0.0, 1.0
    for reward in rewards:
        target += factor * reward
        factor *= discount
    return target if following is None else target + factor * following


def _expected(probabilities: Sequence[float], next_values: NDArray[np.float64]) -> float:
    following: list[float] = next_values.tolist()
    pairs = zip(probabilities, following, strict=True)
    # Actions that a state does not have are worth -inf, and have a probability of 0.
    products = [p * q for p, q in pairs if (p, q) != (0.0, -math.inf)]
    total = products[0]
    for product in products[1:]:
        total += product
    return total
