"""The best policy of an environment with a transition table, by dynamic programming."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils.fields import with_fields
from qtab.discretizers.time_aware import TimeAware
from qtab.envs.tabulation.tabulated_env import TabulatedEnv
from qtab.planning.table import Table
from qtab.planning.tabulated_runs import AnyRun, on_table
from qtab.results.run import Run

METHODS = ("finite_horizon", "value_iteration", "policy_iteration")


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
        """``"best"``, or ``"best known"`` if it is not proven."""
        return "best" if self.proven else "best known"

    def __repr__(self) -> str:
        """A one-line summary without the actions."""
        return f"<StationaryPolicy: {self.label} expected return {self.expected_return:.6g}>"


class TabularSolver:
    """Acts by the solution of a transition table, and evaluates the policies of runs exactly.

    The table is solved by one of ``METHODS``.

    Raises:
        ValueError: if values are unbounded without a discount, except for a finite horizon.
    """

    has_continuous_actions = False

    values: NDArray[np.float64]
    """(states,): the optimal state values."""
    q_values: NDArray[np.float64]
    """(states, actions): the optimal action values."""
    policy: NDArray[np.int64]
    """(states,): the best action, counted from 0; for a finite horizon at the start of an episode."""
    expected_return: float
    """The undiscounted expected return of the policy under the time limit."""
    policy_changes: tuple[NDArray[np.int64], ...] | None
    """For a finite horizon, the changes of the policy as three (changes,) arrays: the steps to go, the state, and the
    action that is best there from that many steps to go on, until the next change. None if the best action does not
    depend on the steps to go."""

    def __init__(self, table: Table, method: str, discount: float, max_episode_steps: int) -> None:
        self.cells, self.actions = table.cells, table.actions
        unwrapped = table.env.unwrapped
        self._tabulated = unwrapped if isinstance(unwrapped, TabulatedEnv) else None
        planner = self._planner = table.solver
        self._max_episode_steps = max_episode_steps
        if method == "finite_horizon":
            solution, self.policy_changes, self.expected_return = planner.finite_horizon(discount, max_episode_steps)
        else:
            solution = getattr(planner, method)(discount)
            self.policy_changes, self.expected_return = None, planner.policy_return(solution[2], max_episode_steps)
        self.values, q_values, self.policy = solution
        self.q_values = q_values.reshape(len(self.values), -1)
        self.needs_step_count = self.policy_changes is not None

    @property
    def observation_shape(self) -> tuple[int, ...]:
        """The shape of an observation: () for a Discrete space."""
        return self.cells.low.shape

    def in_rows(self, observation: Any) -> Any:
        """Returns n observations of a Tuple space as one array; any other observation unchanged."""
        return self.cells.in_rows(observation)

    def action(self, observation: ArrayLike, steps_taken: int) -> int:
        """Returns the best action after a number of steps of the episode.

        Raises:
            ValueError: for an observation outside the space, or one that does not determine the best action.
        """
        row = self.cells.row(observation)
        # Several states share an observation if it hides part of the state.
        best_actions = {
            self._best_action(int(state), steps_taken) for state in np.flatnonzero(self._planner.rows == row)
        }
        if len(best_actions) > 1:
            raise ValueError(f"the best action depends on what the observation {observation!r} does not show")
        return best_actions.pop() + self.actions.first

    def _best_action(self, state: int, steps_taken: int) -> int:
        if self.policy_changes is None:
            return int(self.policy[state])
        steps_to_go, states, actions = self.policy_changes
        remaining = max(self._max_episode_steps - steps_taken, 1)
        # Sorted by the steps to go: the last applicable change counts.
        applicable = np.flatnonzero((states == state) & (steps_to_go <= remaining))
        return int(actions[applicable[-1]])

    def as_solved(self, run: AnyRun) -> AnyRun:
        """Returns a run, or runs, on the solved table, if it was trained on the environment that was tabulated.

        Raises:
            ValueError: if that environment has the same name as the run's, but differs from it.
        """
        return run if self._tabulated is None else on_table(run, self._tabulated)

    def greedy_return(self, run: Run) -> tuple[float, float]:
        """Returns the expected return of a run's greedy policy, and 0.0 as its standard error, as it is exact.

        Raises:
            ValueError: if the run's Q table does not have the environment's shape, or its rows are not the states.
        """
        run = self.as_solved(run)
        cells, steps = run.discretizer, tuple[int, ...]()
        if isinstance(cells, TimeAware):
            cells, steps = cells.cells, (self._max_episode_steps,)
        if not cells.has_component_axes:
            raise ValueError(
                "run must have a table of the components of its observations, not of a function or of max_rows; "
                "qtab.evaluate(run) estimates its return"
            )
        shape = (*steps, *self.cells.shape, len(self.actions))
        found = (*run.discretizer.shape, len(run.actions))
        if not run.discretizer.has_cells or found != shape:
            raise ValueError(f"run must have a table of shape {shape}, got {found}")
        policy: Any = np.ascontiguousarray(run.policy.reshape(*steps, -1) - run.actions.first)
        return self._planner.policy_return(policy, self._max_episode_steps), 0.0

    def attainable_return(self, run: Run) -> float | None:
        """Returns the return of the best policy known that counts steps only if the run's does; None if unknown."""
        if run.config.time_aware:
            return self.expected_return
        return None if self.stationary is None else self.stationary.expected_return

    @cached_property
    def stationary(self) -> StationaryPolicy | None:
        """The best policy known that does not depend on the number of steps taken; None for large tables."""
        found = self._planner.stationary_policy(self.cells.n_rows, self._max_episode_steps)
        if found is None:
            return None
        policy, expected, proven = found
        return StationaryPolicy(policy.reshape(self.cells.shape) + self.actions.first, expected, proven)
