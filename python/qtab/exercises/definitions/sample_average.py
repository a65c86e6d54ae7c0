"""Exercise 2: the sample average of a bandit's rewards."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.exercises.exercise import Exercise
from qtab.exercises.function_check import FunctionCheck
from qtab.exercises.parts import NONE, Mistakes

STARTER = '''\
import numpy as np


def sample_average(estimates, counts, action, reward):
    """Learn from one reward of a bandit: change estimates and counts in place.

    The estimate of an action is the average of its rewards so far. With the n-th
    reward of an action, n counting this one:
    estimate += 1 / n * (reward - estimate).

    estimates: the estimate of each action, float64, of shape (actions,).
    counts: the number of rewards of each action so far, int64, of shape (actions,).
    action: the number of the chosen action.
    reward: its reward.
    """
'''


def sample_average(
    estimates: NDArray[np.float64], counts: NDArray[np.int64], action: int, reward: float, wrong: Mistakes = NONE
) -> None:
    """Updates the estimate and the count of an action."""
    if "first_action" in wrong:
        action = 0
    counts[action] += 1
    n = counts.sum() if "all_counts" in wrong else counts[action]
    if "count_late" in wrong:
        n = max(counts[action] - 1, 1)
    if "rounding" in wrong:
        estimates[action] += (reward - estimates[action]) / n
    elif "no_old_value" in wrong:
        estimates[action] += 1 / n * reward
    else:
        estimates[action] += 1 / n * (reward - estimates[action])


def _calls(actions: int, steps: int) -> Iterator[dict[str, Any]]:
    """Yields rewards of one bandit: the calls share estimates and counts."""
    rng = np.random.default_rng(3)
    estimates, counts = np.zeros(actions), np.zeros(actions, dtype=np.int64)
    for _ in range(steps):
        reward = float(rng.normal(1.0))
        yield {"estimates": estimates, "counts": counts, "action": int(rng.integers(actions)), "reward": reward}


EXERCISE = Exercise(
    number=2,
    name="sample_average",
    title="Sample averages of a bandit",
    section="2.4",
    starter=STARTER,
    model=sample_average,
    mistakes=("count_late", "all_counts", "first_action", "no_old_value", "rounding"),
    checks=[
        FunctionCheck("one action, 20 rewards", sample_average, lambda: _calls(1, 20), (), ("estimates", "counts")),
        FunctionCheck("ten actions, 200 rewards", sample_average, lambda: _calls(10, 200), (), ("estimates", "counts")),
    ],
)
