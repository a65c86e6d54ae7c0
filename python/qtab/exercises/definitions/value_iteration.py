"""Exercise 4: value iteration."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.definitions.tables import Transitions, action_value, transitions
from qtab.exercises.exercise import Exercise
from qtab.exercises.function_check import FunctionCheck
from qtab.exercises.parts import NONE, Mistakes
from qtab.exercises.record import Misuse

MOST_SWEEPS = 1000
"""The number of sweeps after which the reference gives up, if mistakes are built in: some of them hardly converge."""
STARTER = '''\
import numpy as np


def value_iteration(P, discount, tolerance):
    """Find the optimal values, and return (values, policy).

    Start with zeros, float64. Sweep over the states in order:
    v(s) = the largest q(s, a), where
    q(s, a) = sum over the outcomes of p * (reward + discount * v(next state)).
    Start each sum at 0.0 and add its terms in order. A state uses the new values of
    earlier states; after a terminated outcome the next value is 0. Stop after the
    first sweep in which no value changes by more than tolerance. The policy is the
    first action with the largest q(s, a), int64, of shape (states,).

    P: P[state][action] is a list of outcomes (p, next_state, reward, terminated).
    discount: the factor of the next value.
    tolerance: the largest change that is small enough.
    """
'''


def value_iteration(
    P: Transitions,  # noqa: N803 - Gymnasium's name
    discount: float,
    tolerance: float,
    wrong: Mistakes = NONE,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns the optimal values and a greedy policy.

    Raises:
        Misuse: if the values do not converge with the mistakes that are built in.
    """
    values, extra, sweeps = np.zeros(len(P)), "one_sweep_more" in wrong, 0
    while True:
        sweeps += 1
        if wrong and sweeps > MOST_SWEEPS:
            raise Misuse(f"no convergence in {MOST_SWEEPS} sweeps")
        before = values.copy()
        source = before if "two_arrays" in wrong else values
        for state in range(len(P)):
            q = [action_value(P, source, state, action, discount, wrong) for action in range(len(P[state]))]
            values[state] = np.mean(q) if "average_not_max" in wrong else max(q)
        change = values - before
        if (change if "signed_change" in wrong else np.abs(change)).max() <= tolerance:
            if not extra:
                break
            extra = False
    policy = [
        int(np.argmax([action_value(P, values, state, action, discount, wrong) for action in range(len(P[state]))]))
        for state in range(len(P))
    ]
    return values, np.array(policy, dtype=np.int64)


def _calls(env_id: str, discount: float) -> Iterator[dict[str, Any]]:
    for tolerance in (1e-2, 1e-6):
        yield {"P": transitions(env_id), "discount": discount, "tolerance": tolerance}


def _check(env_id: str, states: int, discount: float) -> FunctionCheck:
    returns = [("values", np.zeros(states)), ("policy", np.zeros(states, dtype=np.int64))]
    title = f"{env_id}, discount {discount:g}"
    return FunctionCheck(title, value_iteration, lambda: _calls(env_id, discount), returns)


EXERCISE = Exercise(
    number=4,
    name="value_iteration",
    title="Value iteration",
    section="4.4",
    starter=STARTER,
    model=value_iteration,
    mistakes=("two_arrays", "one_sweep_more", "signed_change", "average_not_max", "no_discount", "discounted_reward"),
    checks=[_check("CliffWalking-v1", 48, 0.9), _check("FrozenLake-v1", 16, 0.95)],
)
