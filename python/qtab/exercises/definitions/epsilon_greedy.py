"""Exercise 1: the epsilon-greedy policy."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises import parts
from qtab.exercises.exercise import Exercise
from qtab.exercises.function_check import FunctionCheck
from qtab.exercises.parts import NONE, POLICY, Mistakes

STARTER = '''\
import numpy as np


def epsilon_greedy(values, epsilon, rng):
    """Return the number of an action.

    Draw one number with rng.random(). If it is less than 1 - epsilon, return the
    action with the largest value, the first one of several. Otherwise draw an action
    with rng.integers(n), where n is the number of actions.

    values: the value of each action, an array of shape (n,). Do not change it.
    epsilon: the probability of a random action.
    rng: a generator of random numbers, np.random.Generator.
    """
'''


def epsilon_greedy(
    values: NDArray[np.float64], epsilon: float, rng: np.random.Generator, wrong: Mistakes = NONE
) -> int:
    """Returns an action."""
    return parts.epsilon_greedy(values, epsilon, rng, wrong)


def _calls(epsilon: float, decimals: int) -> Iterator[dict[str, Any]]:
    """Yields values of 2 to 7 actions with few decimals, so that some are equal; the calls share a generator."""
    makes_values, rng = np.random.default_rng(1), np.random.default_rng(2)
    for number in range(60):
        values = makes_values.normal(size=2 + (number + 3) % 6).round(decimals) + 0.0
        yield {"values": values, "epsilon": epsilon, "rng": rng}


EXERCISE = Exercise(
    number=1,
    name="epsilon_greedy",
    title="The epsilon-greedy policy",
    section="2.2",
    starter=STARTER,
    model=epsilon_greedy,
    mistakes=POLICY,
    checks=[
        FunctionCheck("greedy: epsilon = 0", epsilon_greedy, lambda: _calls(0.0, 6), [("action", 0)]),
        FunctionCheck("equal values: epsilon = 0", epsilon_greedy, lambda: _calls(0.0, 0), [("action", 0)]),
        FunctionCheck("at random: epsilon = 1", epsilon_greedy, lambda: _calls(1.0, 6), [("action", 0)]),
        FunctionCheck("both: epsilon = 0.3", epsilon_greedy, lambda: _calls(0.3, 0), [("action", 0)]),
    ],
)
