"""``qtab.policy_values``: the exact values of a given policy, by dynamic programming."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from qtab import _core
from qtab._utils import checks, html
from qtab._utils.fields import with_fields
from qtab.config.unknown import suggesting
from qtab.envs.tabulation.tabulated_env import TabulatedEnv
from qtab.planning.policies import GivenPolicy, probabilities
from qtab.planning.table import opened_table
from qtab.planning.tabulated_runs import on_table
from qtab.results.run import Run


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class PolicyValues:
    """The exact values of a policy in an environment with a transition table."""

    env: str
    """The environment's id, or the name of its class."""
    discount: float
    """The discount of the values; 1 means no discount."""
    values: NDArray[np.float64]
    """(*cells,): the state values. If an observation hides part of the state, such as Blackjack's naturals, the values
    are those of the state that the observation shows."""
    q_values: NDArray[np.float64]
    """(*cells, actions): the action values: each action is taken once, and the policy is followed from then on."""
    probabilities: NDArray[np.float64]
    """(*cells, actions): the policy, as the probabilities of its actions."""
    error: float
    """A bound on the error of every state value: the largest expected (discounted) sum, over the steps to the end of an
    episode, of the residuals of the Bellman equation and of the rounding errors."""
    expected_return: float
    """The expected discounted return of an episode from the environment's initial states, without a time limit."""
    solver: _core.MdpSolver = field(repr=False)
    """The environment, for :attr:`visits`."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """The state values, so that NumPy's functions accept the result as an array."""
        return np.array(self.values, dtype=dtype, copy=copy) if copy else np.asarray(self.values, dtype=dtype)

    @cached_property
    def visits(self) -> NDArray[np.float64]:
        """(*cells,): the expected number of visits of each state in an episode (Sutton & Barto, 2nd ed., eq. 9.2).

        Raises:
            ValueError: if episodes under this policy may never end.
        """
        flat = np.ascontiguousarray(self.probabilities.reshape(-1))
        every = self.solver.expected_visits(flat)
        # Several states share a row if the observation hides part of the state.
        rows = np.zeros(self.values.size)
        np.add.at(rows, self.solver.rows, every)
        return rows.reshape(self.values.shape)

    @property
    def state_distribution(self) -> NDArray[np.float64]:
        """(*cells,): the on-policy distribution: the fraction of time steps spent in each state (eq. 9.3).

        Raises:
            ValueError: if episodes under this policy may never end.
        """
        distribution: NDArray[np.float64] = self.visits / self.visits.sum()
        return distribution

    def __repr__(self) -> str:
        """A one-line summary without the values."""
        return (
            f"<PolicyValues of {self.env}: {' x '.join(map(str, self.values.shape))} states, discount "
            f"{self.discount:g}, expected return {self.expected_return:.6g}, error below {self.error:.1g}>"
        )

    def _repr_html_(self) -> str:
        """A table and the state values, for notebooks."""
        facts: dict[str, object] = {
            "expected return": f"{self.expected_return:.6g}",
            "discount": f"{self.discount:g}",
            "error": f"below {self.error:.1g}",
            "states": " × ".join(map(str, self.values.shape)),
        }
        picture = html.state_values("State values", self.values)
        return html.summary(f"Values of a policy in {self.env}", facts, picture)


@suggesting
def policy_values(
    env: str | EnvSpec | gym.Env,
    policy: GivenPolicy,
    discount: float = 1.0,
    *,
    env_kwargs: Mapping[str, Any] | None = None,
) -> PolicyValues:
    """Computes the exact values of a policy by iterative policy evaluation (Sutton & Barto, 2nd ed., section 4.1).

    If that takes many sweeps, as with episodes of thousands of steps, tables of up to 2,000 states are solved directly.
    The values are those of episodes without a time limit, up to rounding errors that ``error`` bounds. They exist for
    every environment with a transition table: toy text, :class:`qtab.TabularEnv`, any other environment with ``P`` and
    ``initial_state_distrib``, and Blackjack, whose table follows from its rules.

    Args:
        env: A Gymnasium id, an ``EnvSpec`` or an environment, which is neither stepped nor closed.
        policy: ``"random"`` for equal probabilities; an array (*cells,) of actions or (*cells, actions) of
            probabilities; a function from an observation to an action or to (actions,) probabilities; a run, for its
            greedy policy; or an optimum that does not depend on the steps left. In a table that :func:`qtab.tabulate`
            made of the run's environment, a run acts in each state by its observation.
        discount: The discount, in [0, 1].
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        OverflowError: if values exceed the range of float64.
        TypeError: for an argument of the wrong type.
        ValueError: for a policy of the wrong shape or with probabilities that do not sum to 1, an environment without a
            transition table, or a policy that collects rewards forever without a discount.
    """
    discount = checks.real("discount", discount, 0.0, 1.0)
    with opened_table(env, env_kwargs) as table:
        cells, actions, solver = table.cells, table.actions, table.solver
        unwrapped = table.env.unwrapped
        if isinstance(policy, Run) and isinstance(unwrapped, TabulatedEnv):
            policy = on_table(policy, unwrapped)
        given = probabilities("policy", policy, table.env.observation_space, cells, actions)
    values, q_values, error = solver.policy_evaluation(np.ascontiguousarray(given.ravel()), discount)
    observed = slice(cells.n_rows)
    return PolicyValues(
        env=table.name,
        discount=discount,
        values=values[observed].reshape(cells.shape),
        q_values=q_values.reshape(len(values), -1)[observed].reshape(*cells.shape, len(actions)),
        probabilities=given.reshape(*cells.shape, len(actions)),
        error=error,
        expected_return=float(np.dot(solver.initial_distribution, values)),
        solver=solver,
    )
