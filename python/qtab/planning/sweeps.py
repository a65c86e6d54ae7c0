"""Dynamic programming step by step: the values after each sweep, and the policies of policy iteration."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from qtab import _core
from qtab._utils import checks
from qtab.discretizers.identity import Identity
from qtab.envs.actions import Actions
from qtab.planning.policies import GivenPolicy, probabilities
from qtab.planning.table import opened_table

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Improvement:
    """A policy from policy iteration, with its values."""

    policy: NDArray[np.int64]
    """(*cells,): the action in each state."""
    values: FloatArray
    """(*cells,): the values of the policy."""


def policy_evaluation(
    env: str | EnvSpec | gym.Env,
    policy: GivenPolicy,
    discount: float = 1.0,
    *,
    in_place: bool = True,
    env_kwargs: Mapping[str, Any] | None = None,
) -> Iterator[FloatArray]:
    """Yields the state values of iterative policy evaluation: first zeros, then the values after each sweep, forever.

    Sutton & Barto, 2nd ed., section 4.1, equation 4.5. :func:`qtab.policy_values` returns the values at convergence.

    Args:
        env: A Gymnasium id, an ``EnvSpec`` or an environment with a transition table, which is neither stepped nor
            closed.
        policy: As for :func:`qtab.policy_values`.
        discount: The discount, in [0, 1].
        in_place: Whether a sweep uses the new values of the states before, instead of the old values of all states.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.

    Yields:
        (*cells,) float64: a new array each time.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        OverflowError: if values exceed the range of float64.
        TypeError: for an argument of the wrong type.
        ValueError: for an environment without a transition table, or a policy that does not fit it.
    """
    discount, in_place = checks.real("discount", discount, 0.0, 1.0), checks.boolean("in_place", in_place)
    with opened_table(env, env_kwargs) as table:
        given = probabilities("policy", policy, table.env.observation_space, table.cells, table.actions)
        solver, cells = table.solver, table.cells
    return _sweeps(solver, cells, discount, np.ascontiguousarray(given.ravel()), in_place)


def value_iteration(
    env: str | EnvSpec | gym.Env,
    discount: float = 1.0,
    *,
    in_place: bool = True,
    env_kwargs: Mapping[str, Any] | None = None,
) -> Iterator[FloatArray]:
    """Yields the state values of value iteration: first zeros, then the values after each sweep, forever.

    Sutton & Barto, 2nd ed., section 4.4, equation 4.10. :func:`qtab.optimum` returns the values at convergence, and the
    policy. The arguments, the arrays and the errors are those of :func:`policy_evaluation`.
    """
    discount, in_place = checks.real("discount", discount, 0.0, 1.0), checks.boolean("in_place", in_place)
    with opened_table(env, env_kwargs) as table:
        solver, cells = table.solver, table.cells
    return _sweeps(solver, cells, discount, None, in_place)


def _sweeps(
    solver: _core.MdpSolver, cells: Identity, discount: float, policy: FloatArray | None, in_place: bool
) -> Iterator[FloatArray]:
    # The first states are those that observations show.
    values = np.zeros(len(solver.rows))
    while True:
        yield values[: cells.n_rows].reshape(cells.shape).copy()
        values = solver.sweep(values, discount, policy, in_place)


def policy_iteration(
    env: str | EnvSpec | gym.Env,
    discount: float = 1.0,
    *,
    policy: GivenPolicy = 0,
    env_kwargs: Mapping[str, Any] | None = None,
) -> Iterator[Improvement]:
    """Yields the policies of policy iteration with their values, from the initial to the optimal one.

    Sutton & Barto, 2nd ed., section 4.3. An action is replaced only if another is better by more than rounding errors.
    Ties go to the first action.

    Args:
        env: As for :func:`policy_evaluation`.
        discount: The discount, in [0, 1].
        policy: The initial policy, as for :func:`qtab.policy_values`, with one action for each state; or a single
            action for all states.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        OverflowError: if values exceed the range of float64.
        TypeError: for an argument of the wrong type.
        ValueError: for an environment without a transition table, a policy that does not fit it, or one that collects
            rewards forever without a discount.
    """
    discount = checks.real("discount", discount, 0.0, 1.0)
    with opened_table(env, env_kwargs) as table:
        cells, actions = table.cells, table.actions
        first: Any = np.full(cells.shape, policy) if isinstance(policy, int | np.integer) else policy
        given = probabilities("policy", first, table.env.observation_space, cells, actions)
        solver = table.solver
    if not ((given == 0.0) | (given == 1.0)).all():
        raise ValueError("policy must take one action in each state, got probabilities between 0 and 1")
    return _improvements(solver, cells, actions, discount, np.argmax(given, axis=1))


def _improvements(
    solver: _core.MdpSolver, cells: Identity, actions: Actions, discount: float, policy: NDArray[np.int64]
) -> Iterator[Improvement]:
    while True:
        values, better = solver.policy_improvement(policy, discount)
        yield Improvement(policy.reshape(cells.shape) + actions.first, values[: cells.n_rows].reshape(cells.shape))
        # The first states are those that observations show.
        if better is None or np.array_equal(better[: cells.n_rows], policy):
            return
        policy = better[: cells.n_rows].copy()
