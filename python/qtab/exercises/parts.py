"""The parts that the models of the exercises share, each with the mistakes that students make in it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Mistakes = frozenset[str]
"""The keys of the mistakes that are built in; see :mod:`qtab.exercises.mistakes`."""
NONE: Mistakes = frozenset()

POLICY = (
    "epsilon_inverted",
    "epsilon_inverted_other_draws",
    "explores_below_epsilon",
    "draws_action_first",
    "explores_without_greedy",
    "random_ties",
    "last_tie",
)
"""The mistakes of :func:`epsilon_greedy`."""
UPDATE = ("truncation", "terminal_value", "swapped_rates", "no_discount", "no_old_value", "rounding")
"""The mistakes of :func:`rates`, :func:`nothing_follows` and :func:`move`."""
STEPS = ("state_kept", "no_last_update")
"""The mistakes of :func:`state_after` and :func:`stops_before_update`."""


def epsilon_greedy(values: NDArray[np.float64], epsilon: float, rng: np.random.Generator, wrong: Mistakes) -> int:
    """Draws ``random()``, and an integer to explore; ties go to the first action."""
    n = len(values)
    if "draws_action_first" in wrong:
        action = int(rng.integers(n))
        return _greedy(values, rng, wrong) if rng.random() < 1.0 - epsilon else action
    draw = rng.random()
    if "epsilon_inverted" in wrong:
        is_greedy = draw < epsilon
    elif "epsilon_inverted_other_draws" in wrong:
        is_greedy = draw >= 1.0 - epsilon
    elif "explores_below_epsilon" in wrong:
        is_greedy = draw >= epsilon
    else:
        is_greedy = draw < 1.0 - epsilon
    if is_greedy:
        return _greedy(values, rng, wrong)
    if "explores_without_greedy" in wrong:
        best = _greedy(values, rng, wrong)
        return [action for action in range(n) if action != best][int(rng.integers(n - 1))]
    return int(rng.integers(n))


def _greedy(values: NDArray[np.float64], rng: np.random.Generator, wrong: Mistakes) -> int:
    best = np.flatnonzero(values == values.max())
    if "random_ties" in wrong:
        return int(best[rng.integers(len(best))])
    return int(best[-1] if "last_tie" in wrong else best[0])


def rates(learning_rate: float, discount: float, wrong: Mistakes) -> tuple[float, float]:
    """Returns the learning rate and the discount."""
    if "swapped_rates" in wrong:
        return discount, learning_rate
    return learning_rate, 1.0 if "no_discount" in wrong else discount


def nothing_follows(terminated: bool, truncated: bool, wrong: Mistakes) -> bool:
    """Returns whether the value of the next state is left out of the target."""
    if "terminal_value" in wrong:
        return False
    return terminated or (truncated and "truncation" in wrong)


def stops_before_update(over: bool, wrong: Mistakes) -> bool:
    """Returns whether the loop over the steps of an episode is left before the update of this step."""
    return over and "no_last_update" in wrong


def state_after(state: int, next_state: int, wrong: Mistakes) -> int:
    """Returns the state of the next step."""
    return state if "state_kept" in wrong else next_state


def move(table: NDArray[np.float64], index: Any, rate: float, target: float, wrong: Mistakes) -> None:
    """Moves a value towards a target: value += rate * (target - value)."""
    if "rounding" in wrong:
        table[index] = (1 - rate) * table[index] + rate * target
    elif "no_old_value" in wrong:
        table[index] += rate * target
    else:
        table[index] += rate * (target - table[index])
