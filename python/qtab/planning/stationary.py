"""The best stationary policy known: one action for each observation, whatever the number of steps taken."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._utils.fields import with_fields

DISCOUNTS = (1.0, 0.9999, 0.9995, 0.999, 0.998, 0.995, 0.99, 0.98, 0.97, 0.95, 0.9, 0.8, 0.7, 0.5, 0.2)
"""The discounts whose policies are tried."""
SWEEPS_PER_STEP = 4
"""Value iteration takes so many sweeps for each step before the time limit, fewer where that takes too long."""
LEAST_SWEEPS = 100
MAX_PAIR_UPDATES = 2 * 10**7
"""Nothing is searched for a table with more state-action pairs times steps."""
MAX_UPDATES = 5 * 10**7
"""How many outcomes value iteration may look at, and then the changes of single actions: less than a second each."""
TOLERANCE = 1e-12
"""What two equal returns may differ by, relative to their size: they are sums in another order."""


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class StationaryPolicy:
    """A policy that does not depend on the number of steps taken, and its return under the time limit."""

    policy: NDArray[np.int64]
    """(*cells,): the action in each cell, as the environment numbers it."""
    expected_return: float
    """The undiscounted expected return under the time limit."""
    proven: bool
    """Whether no stationary policy returns more: true if no policy at all does."""

    @property
    def label(self) -> str:
        """``"best"``, or ``"best known"`` where it is not proven."""
        return "best" if self.proven else "best known"

    def __repr__(self) -> str:
        """One line: the actions are not shown."""
        return f"<StationaryPolicy: {self.label} expected return {self.expected_return:.6g}>"


def stationary_policy(
    planner: _core.MdpSolver, n_rows: int, max_episode_steps: int
) -> tuple[NDArray[np.int64], float, bool] | None:
    """Searches for the stationary policy with the largest undiscounted return under a time limit.

    The policies of value iteration with several discounts are compared; the best one is then improved by changes of the
    action of one observation until none helps. All returns are exact.

    Args:
        planner: The transition table.
        n_rows: The number of different observations.
        max_episode_steps: The time limit.

    Returns:
        (n_rows,) the actions, counted from 0, their expected return, and whether it is that of the best policy of all;
        None if the table is too large to be searched in seconds.
    """
    if len(planner.rows) * planner.n_actions * max_episode_steps > MAX_PAIR_UPDATES:
        return None
    n_outcomes = sum(map(len, planner.transitions()))
    sweeps = max(SWEEPS_PER_STEP * max_episode_steps, LEAST_SWEEPS)
    sweeps = min(sweeps, MAX_UPDATES // (len(DISCOUNTS) * n_outcomes))
    if sweeps < LEAST_SWEEPS:
        return None
    _, _, optimal = planner.finite_horizon(1.0, max_episode_steps)
    best, best_return = np.zeros(n_rows, np.int64), -math.inf
    for discount in DISCOUNTS:
        # Where an observation hides part of the state, the first states are those that it shows.
        (_, _, policy), _, _ = planner.finite_horizon(discount, sweeps)
        policy = np.ascontiguousarray(policy[:n_rows])
        expected = planner.policy_return(policy, max_episode_steps)
        if expected > best_return:
            best, best_return = policy, expected
        if _reaches(best_return, optimal):
            return best, best_return, True
    changes = MAX_UPDATES * planner.n_actions // (n_outcomes * max_episode_steps)
    best, best_return = _improved(planner, best, best_return, max_episode_steps, changes)
    return best, best_return, _reaches(best_return, optimal)


def _improved(
    planner: _core.MdpSolver, policy: NDArray[np.int64], expected: float, max_episode_steps: int, most: int
) -> tuple[NDArray[np.int64], float]:
    """Takes every change of a single action that helps, in turn, until none does or so many were tried."""
    policy, unchanged, row = policy.copy(), 0, 0
    while unchanged < len(policy):
        unchanged += 1
        for action in range(planner.n_actions):
            if action == policy[row]:
                continue
            if most == 0:
                return policy, expected
            most -= 1
            kept, policy[row] = policy[row], action
            changed = planner.policy_return(policy, max_episode_steps)
            if changed > expected + TOLERANCE * abs(expected):
                expected, unchanged = changed, 0
            else:
                policy[row] = kept
        row = (row + 1) % len(policy)
    return policy, expected


def _reaches(expected: float, optimal: float) -> bool:
    return math.isclose(expected, optimal, rel_tol=TOLERANCE)
