"""Dynamic programming over a transition table (Sutton & Barto, 2nd ed., chapter 4), in plain NumPy.

``P[state][action]`` lists (probability, next state, reward, terminated), as in Gymnasium's toy text. Sums go from left
to right, so that :func:`qtab.optimum` gives the same values to the last bit.
"""

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

LAST_BITS = 4 * sys.float_info.epsilon


def action_value(P: Any, V: Sequence[float] | NDArray[np.float64], s: int, a: int, discount: float) -> float:
    """Σ p (r + γ V(s')): what comes after a terminal step counts nothing (eq. 4.6)."""
    value = 0.0
    for p, s_next, r, terminated in P[s][a]:
        value += p * (r + discount * (0.0 if terminated else V[s_next]))
    return value


def value_iteration(P: Any, discount: float) -> NDArray[np.float64]:
    """V(s) ← max_a Σ p (r + γ V(s')), in place, until changes are in the last bits and shrink no more (eq. 4.10)."""
    V = np.zeros(len(P)).tolist()
    before = float("inf")
    while True:
        change = 0.0
        for s in range(len(P)):
            v = V[s]
            V[s] = max(action_value(P, V, s, a, discount) for a in range(len(P[s])))
            change = max(change, abs(V[s] - v))
        if change == 0.0 or (change <= LAST_BITS * max(map(abs, V)) and change >= before):
            return np.array(V)
        before = change


def finite_horizon(P: Any, discount: float, steps: int) -> NDArray[np.float64]:
    """The best values with all steps left: V_k(s) = max_a Σ p (r + γ V_{k-1}(s')), V_0 = 0."""
    V = np.zeros(len(P)).tolist()
    for _ in range(steps):
        V = [max(action_value(P, V, s, a, discount) for a in range(len(P[s]))) for s in range(len(P))]
    return np.array(V)


def policy_return(P: Any, initial_state_distrib: Any, policy: Any, steps: int) -> float:
    """What a policy that never changes returns on average within so many steps, without a discount."""
    V = np.zeros(len(P)).tolist()
    for _ in range(steps):
        V = [action_value(P, V, s, policy[s], 1.0) for s in range(len(P))]
    expected = 0.0
    for probability, v in zip(initial_state_distrib, V, strict=True):
        expected += probability * v
    return float(expected)
