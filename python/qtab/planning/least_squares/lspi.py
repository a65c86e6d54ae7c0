"""``qtab.planning.lspi``: least-squares policy iteration."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab._utils.fields import with_fields
from qtab._utils.shown import counted
from qtab.config.unknown import suggesting
from qtab.planning.least_squares.lstdq import (
    FloatArray,
    GivenActions,
    GivenFeatures,
    batch_of,
    checked_epsilon,
    chosen_actions,
    feature_vectors,
)
from qtab.planning.least_squares.transitions import Transitions, observed


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class LeastSquaresPolicy:
    """The greedy policy of linear action values, found by :func:`qtab.planning.lspi`.

    It is itself a function from an observation to an action, as :func:`qtab.policy_values` and
    :func:`qtab.estimate_values` take them, for environments whose actions are numbered from 0.
    """

    history: FloatArray
    """(iterations, d, actions): the weights of the policy of each iteration, those of the initial policy first."""
    converged: bool
    """Whether the last two weights differ by less than the tolerance; if not, the last policy need not be the best."""
    discount: float
    """The discount γ."""
    features: GivenFeatures = field(repr=False)
    """x(s), as given."""

    @property
    def weights(self) -> FloatArray:
        """(d, actions): the last weights."""
        weights: FloatArray = self.history[-1]
        return weights

    def q_values(self, observations: ArrayLike, iteration: int = -1) -> FloatArray:
        """Returns the action values x(s) · w_a of n observations, (n, actions).

        Args:
            observations: (n, *shape): the observations.
            iteration: The iteration of the weights, counted from 0; -1 means the last one.

        Raises:
            IndexError: for an iteration that was not made.
            TypeError: if the observations are not numbers, or not integers for features in an array.
            ValueError: if the observations do not fit the features.
        """
        x = feature_vectors(self.features, observed("observations", observations))
        values: FloatArray = x @ self.history[iteration]
        return values

    def actions(self, observations: ArrayLike, iteration: int = -1) -> NDArray[np.int64]:
        """Returns the greedy actions of n observations, (n,), counted from 0; see :meth:`q_values`.

        Ties go to the first action.
        """
        chosen: NDArray[np.int64] = np.argmax(self.q_values(observations, iteration), axis=1)
        return chosen

    def __call__(self, observation: Any) -> int:
        """Returns the greedy action of one observation, counted from 0."""
        return int(self.actions(np.asarray(observation)[np.newaxis])[0])

    def __repr__(self) -> str:
        """A one-line summary without the weights."""
        iterations, d, actions = self.history.shape
        end = "" if self.converged else ", not converged"
        return (
            f"<LeastSquaresPolicy of {counted(d, 'feature')} and {counted(actions, 'action')}: "
            f"{counted(iterations, 'iteration')}{end}>"
        )


@suggesting
def lspi(
    transitions: Transitions,
    features: GivenFeatures,
    discount: float = 0.9,
    *,
    policy: GivenActions = 0,
    epsilon: float = 0.0,
    tolerance: float = 1e-5,
    max_iterations: int = 100,
) -> LeastSquaresPolicy:
    """Finds a policy by least-squares policy iteration: evaluates it by LSTDQ, makes it greedy, and repeats.

    M. Lagoudakis and R. Parr, "Least-squares policy iteration", Journal of Machine Learning Research 4, 2003.
    Every iteration uses the same transitions, without a step size. It runs in NumPy. With a feature for each state and
    all transitions of a table, it is policy iteration.

    Args:
        transitions: The transitions: from arrays, from a table, from an environment, or from the recorded episodes of a
            run.
        features: x(s), as for :func:`qtab.planning.lstdq`: (states, d) or (*cells, d) numbers, or a function from an
            observation to (d,) numbers. Each action has weights of its own.
        discount: The discount γ, in [0, 1].
        policy: The initial policy, as for :func:`qtab.planning.lstdq`: a single action for all states; an array; or a
            function from an observation to an action.
        epsilon: ε, at least 0: A begins as ε times the identity.
        tolerance: The iterations end when no weight changes by as much as this. The greedy action is the one with the
            largest value; ties go to the first action.
        max_iterations: The largest number of iterations. The policies may repeat in a cycle and never converge.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, features or a policy that do not fit the observations, or if A is
            singular, with the features whose weights are not determined.
    """
    discount, epsilon = checks.real("discount", discount, 0.0, 1.0), checked_epsilon(epsilon)
    tolerance = checks.finite("tolerance", tolerance)
    if tolerance <= 0.0:
        raise ValueError(f"tolerance must be above 0, got {tolerance:g}")
    max_iterations = checks.integer("max_iterations", max_iterations, least=1)
    batch = batch_of(transitions, features)
    following = chosen_actions("policy", policy, transitions)
    history: list[FloatArray] = []
    converged = False
    while len(history) < max_iterations and not converged:
        weights = batch.solve(following, discount, epsilon)
        converged = bool(history) and bool(np.abs(weights - history[-1]).max() < tolerance)
        history.append(weights)
        following = np.argmax(batch.next_x @ weights, axis=1)
    return LeastSquaresPolicy(np.array(history), converged, discount, features)
