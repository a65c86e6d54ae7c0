"""Exercise 3: a sweep of policy evaluation."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.definitions.tables import Transitions, action_value, transitions
from qtab.exercises.exercise import Exercise
from qtab.exercises.function_check import FunctionCheck
from qtab.exercises.parts import NONE, Mistakes

STARTER = '''\
import numpy as np


def policy_evaluation(P, policy, values, discount):
    """Make one sweep of policy evaluation; return the new values, of shape (states,).

    v(s) = sum over actions a of policy[s, a] * q(s, a), where
    q(s, a) = sum over the outcomes of p * (reward + discount * v(next state)).
    All states use the old values. After a terminated outcome the next value is 0.
    Start each sum at 0.0 and add its terms in order.

    P: P[state][action] is a list of outcomes (p, next_state, reward, terminated).
    policy: the probability of each action in each state, of shape (states, actions).
    values: the old values, of shape (states,). Do not change them.
    discount: the factor of the next value.
    """
'''


def policy_evaluation(
    P: Transitions,  # noqa: N803 - Gymnasium's name
    policy: NDArray[np.float64],
    values: NDArray[np.float64],
    discount: float,
    wrong: Mistakes = NONE,
) -> NDArray[np.float64]:
    """Returns the values after a sweep."""
    new = values.copy()
    old = new if "in_place" in wrong else values
    for state in range(len(values)):
        total = 0.0
        for action in range(policy.shape[1]):
            weight = 1 / policy.shape[1] if "uniform_actions" in wrong else policy[state, action]
            total += weight * action_value(P, old, state, action, discount, wrong)
        new[state] = total
    return new


def _calls(env_id: str, sweeps: int, discount: float) -> Iterator[dict[str, Any]]:
    """Yields a random policy and random values, then the values after each sweep."""
    P, rng = transitions(env_id), np.random.default_rng(4)  # noqa: N806
    policy = rng.dirichlet(np.ones(len(P[0])), size=len(P))
    values = rng.normal(size=len(P))
    for _ in range(sweeps):
        yield {"P": P, "policy": policy, "values": values, "discount": discount}
        values = policy_evaluation(P, policy, values, discount)


def _check(env_id: str, states: int, sweeps: int, discount: float) -> FunctionCheck:
    title, returns = f"{env_id}, {sweeps} sweeps", [("values", np.zeros(states))]
    return FunctionCheck(title, policy_evaluation, lambda: _calls(env_id, sweeps, discount), returns)


EXERCISE = Exercise(
    number=3,
    name="policy_evaluation",
    title="A sweep of policy evaluation",
    section="4.1",
    starter=STARTER,
    model=policy_evaluation,
    mistakes=("in_place", "terminal_value", "uniform_actions", "no_probabilities", "no_discount", "discounted_reward"),
    checks=[_check("CliffWalking-v1", 48, 3, 0.9), _check("FrozenLake-v1", 16, 10, 0.5)],
)
