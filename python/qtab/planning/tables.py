"""What there is to know of an environment with a table."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab import _core
from qtab.discretizers.identity import Cells
from qtab.results.run import Run

METHODS = ("finite_horizon", "value_iteration", "policy_iteration")


@dataclass(frozen=True, eq=False)
class Solution:
    """A table, solved."""

    values: NDArray[np.float64]
    """(states,): the discounted return to come."""
    q_values: NDArray[np.float64]
    """(states, actions)"""
    policy: NDArray[np.int64]
    """(states,): the best action, counted from 0."""
    expected_return: float
    changes: tuple[NDArray[np.int64], ...] | None
    """From how many steps left on, in which state, which action is best; None where steps do not matter."""


def solve(planner: _core.Planner, method: str, discount: float, steps: int) -> Solution:
    """Solves a table by one of ``METHODS``.

    Raises:
        ValueError: where rewards add up for ever without a discount, but for a finite horizon.
    """
    if method == "finite_horizon":
        (values, q_values, policy), changes, expected = planner.finite_horizon(discount, steps)
        return Solution(values, q_values.reshape(len(values), -1), policy, expected, changes)
    values, q_values, policy = getattr(planner, method)(discount)
    expected = planner.policy_return(policy, steps)
    return Solution(values, q_values.reshape(len(values), -1), policy, expected, None)


class TableTruth:
    """Decides by a solved table."""

    def __init__(self, planner: _core.Planner, cells: Cells, solution: Solution, steps: int) -> None:
        self._planner, self._cells, self._solution, self._steps = planner, cells, solution, steps
        self.remembers = solution.changes is not None

    def action(self, observation: ArrayLike, taken: int) -> int:
        """Returns the best action after so many steps of the episode.

        Raises:
            ValueError: for an observation outside the space, or one that hides what the best action depends on.
        """
        [row] = self._cells.lit(np.asarray(observation))
        best = {self._best(int(state), taken) for state in np.flatnonzero(self._planner.rows == row)}
        if len(best) > 1:
            raise ValueError(f"the best action depends on what the observation {observation!r} does not show")
        return best.pop() + self._cells.first_action

    def _best(self, state: int, taken: int) -> int:
        if self._solution.changes is None:
            return int(self._solution.policy[state])
        left, states, actions = self._solution.changes
        # The changes come in the order of the steps left; the last that applies holds.
        applies = np.flatnonzero((states == state) & (left <= max(self._steps - taken, 1)))
        return int(actions[applies[-1]])

    def greedy_return(self, run: Run) -> tuple[float, float]:
        """Returns the expected return of a run's greedy policy, and no error: it is exact.

        Raises:
            ValueError: if the run's table is another.
        """
        if not isinstance(run.grid, Cells) or run.grid.shape != self._cells.shape:
            raise ValueError(f"run must have a table of shape {self._cells.shape}, got {run.grid.shape!r}")
        policy: Any = np.ascontiguousarray(run.policy.ravel() - run.grid.first_action)
        return self._planner.policy_return(policy, self._steps), 0.0
