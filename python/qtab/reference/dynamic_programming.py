"""Dynamic programming over a transition table (Sutton & Barto, 2nd ed., chapter 4), in plain NumPy.

``P[state][action]`` lists (probability, next state, reward, terminated), as in Gymnasium's toy text. Sums go from left
to right, so that :func:`qtab.optimum` gives the same values to the last bit.
"""

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.envs.toy_text.utils import categorical_sample
from numpy.typing import NDArray

LAST_BITS = 4 * sys.float_info.epsilon


def action_value(P: Any, V: Sequence[float] | NDArray[np.float64], s: int, a: int, discount: float) -> float:
    """Returns Σ p (r + γ V(s')), in which a state after a terminal step has the value 0 (eq. 4.6)."""
    value = 0.0
    for p, s_next, r, terminated in P[s][a]:
        value += p * (r + discount * (0.0 if terminated else V[s_next]))
    return value


def action_size(P: Any, V: Sequence[float] | NDArray[np.float64], s: int, a: int, discount: float) -> float:
    """Returns Σ p (|r| + γ |V(s')|): the sum of the magnitudes of the terms of an action value."""
    size = 0.0
    for p, s_next, r, terminated in P[s][a]:
        size += p * (abs(r) + discount * (0.0 if terminated else abs(V[s_next])))
    return size


def value_iteration(P: Any, discount: float) -> NDArray[np.float64]:
    """V(s) ← max_a Σ p (r + γ V(s')), in place, until changes are in the last bits and no longer shrink (eq. 4.10).

    The last bits are relative to the magnitudes of the terms of the largest action value.
    """
    V = np.zeros(len(P)).tolist()
    before = float("inf")
    while True:
        change = 0.0
        for s in range(len(P)):
            q = [action_value(P, V, s, a, discount) for a in range(len(P[s]))]
            v = max(q)
            size = action_size(P, V, s, q.index(v), discount)
            change = max(change, abs(v - V[s]) / max(size, sys.float_info.min))
            V[s] = v
        if change == 0.0 or (change <= LAST_BITS and change >= before):
            return np.array(V)
        before = change


def finite_horizon(P: Any, discount: float, steps: int) -> NDArray[np.float64]:
    """Returns the best values with all steps left: V_k(s) = max_a Σ p (r + γ V_{k-1}(s')), V_0 = 0."""
    V = np.zeros(len(P)).tolist()
    for _ in range(steps):
        V = [max(action_value(P, V, s, a, discount) for a in range(len(P[s]))) for s in range(len(P))]
    return np.array(V)


def policy_return(P: Any, initial_state_distrib: Any, policy: Any, steps: int) -> float:
    """Returns the expected undiscounted return of a fixed policy within ``steps`` steps."""
    V = np.zeros(len(P)).tolist()
    for _ in range(steps):
        V = [action_value(P, V, s, policy[s], 1.0) for s in range(len(P))]
    expected = 0.0
    for probability, v in zip(initial_state_distrib, V, strict=True):
        expected += probability * v
    return float(expected)


def sweep(P: Any, V: Sequence[float], discount: float, policy: Any, in_place: bool) -> list[float]:
    """Makes one sweep: V(s) ← Σ π(a|s) q(s, a) (eq. 4.5), or without a policy max_a q(s, a) (eq. 4.10)."""
    new = list(V)
    for s in range(len(P)):
        old = new if in_place else V
        q = [action_value(P, old, s, a, discount) for a in range(len(P[s]))]
        if policy is None:
            new[s] = max(q)
        else:
            new[s] = 0.0
            for a, value in enumerate(q):
                if policy[s][a] > 0.0:
                    new[s] += policy[s][a] * value
    return new


def expected_updates(
    P: Any, initial_state_distrib: Any, discount: float, epsilon: float | None, seed: int, updates: int
) -> NDArray[np.float64]:
    """Q(s, a) ← Σ p (r + γ max_a' Q(s', a')) for pair after pair (eq. 8.1): in turn, or with ε in episodes."""
    rng = np.random.default_rng(seed)
    Q = np.zeros((len(P), len(P[0])))
    s = None
    for update in range(updates):
        if epsilon is None:
            s, a = divmod(update % Q.size, Q.shape[1])
        else:
            if s is None:
                s = int(categorical_sample(initial_state_distrib, rng))
            best = np.flatnonzero(Q[s] == Q[s].max())
            if rng.random() < 1.0 - epsilon:
                a = int(best[0] if len(best) == 1 else best[rng.integers(0, len(best))])
            else:
                a = int(rng.integers(0, Q.shape[1]))
            chosen = categorical_sample([p for p, _, _, _ in P[s][a]], rng)
            _, s_next, _, terminated = P[s][a][chosen]
        Q[s, a] = action_value(P, Q.max(axis=1), s, a, discount)
        if epsilon is not None:
            s = None if terminated else s_next
    return Q
