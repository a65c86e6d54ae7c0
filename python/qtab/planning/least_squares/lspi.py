"""``qtab.planning.lspi``: least-squares policy iteration."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab._utils.fields import with_fields
from qtab._utils.shown import counted, shown
from qtab.config.functions import checked_mask
from qtab.config.unknown import suggesting
from qtab.planning.least_squares.equations import FloatArray
from qtab.planning.least_squares.lstdq import (
    GivenActions,
    GivenFeatures,
    batch_of,
    checked_epsilon,
    chosen_actions,
    each,
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
    features: Any = field(repr=False)
    """x(s), an array or a function, as given."""
    action_mask: Callable[[Any], Any] | None = field(default=None, repr=False)
    """The available actions of an observation, as given; None if all actions always are."""

    @property
    def weights(self) -> FloatArray:
        """(d, actions): the last weights."""
        weights: FloatArray = self.history[-1]
        return weights

    def q_values(self, observations: ArrayLike, iteration: int = -1) -> FloatArray:
        """Returns the action values x(s) · w_a of n observations, (n, actions); -inf for masked actions.

        Args:
            observations: (n, *shape): the observations.
            iteration: The iteration of the weights, counted from 0; -1 means the last one.

        Raises:
            IndexError: for an iteration that was not made.
            TypeError: if the observations are not numbers, or not integers for features in an array; or for a mask that
                does not hold booleans or integers.
            ValueError: if the observations do not fit the features, or a mask leaves no action, as it may in a terminal
                state.
        """
        x = feature_vectors(self.features, observed("observations", observations))
        values: FloatArray = x @ self.history[iteration]
        if self.action_mask is None:
            return values
        masks = _masks(self.action_mask, np.asarray(observations), values.shape[1])
        return np.where(masks, values, -np.inf)

    def actions(self, observations: ArrayLike, iteration: int = -1) -> NDArray[np.int64]:
        """Returns the greedy actions of n observations, (n,), counted from 0; see :meth:`q_values`.

        Ties go to the first action. Actions that ``action_mask`` excludes are never chosen.
        """
        return _greedy(self.q_values(observations, iteration), None)

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
    action_mask: Callable[[Any], Any] | None = None,
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
            function from an observation to an action. Where ``action_mask`` excludes its action, it takes the first
            available one.
        epsilon: ε, at least 0: A begins as ε times the identity. A small ε keeps weights that the transitions do
            not determine near zero.
        tolerance: The iterations end when no weight changes by as much as this. The greedy action is the one with the
            largest value; ties go to the first action.
        max_iterations: The largest number of iterations. The policies may repeat in a cycle and never converge.
        action_mask: A function from an observation to (actions,) booleans or 0 and 1, the available actions, among
            which each policy chooses; as for :func:`qtab.train`, but observations of several numbers are arrays, also
            where the environment's are tuples: ``table[tuple(observation)]``. The policy that is found reads the masks
            of terminal states, too, if it is asked there. None means that all actions are. The recorded episodes of
            a run with action masks need it.

    Raises:
        MemoryError: if the matrices would take more than half of the machine's memory, or more than is free.
        TypeError: for an argument of the wrong type, or a mask that does not hold booleans or integers.
        ValueError: for an argument out of range, features, a policy or masks that do not fit the observations or the
            actions, no masks for the episodes of a run that had some, or if A is singular, with the features whose
            weights are not determined.
    """
    discount, epsilon = checks.real("discount", discount, 0.0, 1.0), checked_epsilon(epsilon)
    tolerance = checks.finite("tolerance", tolerance)
    if tolerance <= 0.0:
        raise ValueError(f"tolerance must be above 0, got {tolerance:g}")
    max_iterations = checks.integer("max_iterations", max_iterations, least=1)
    batch = batch_of(transitions, features, discount, epsilon)
    masks = _next_masks(action_mask, transitions)
    following = chosen_actions("policy", policy, transitions)
    if masks is not None:
        is_available = masks[np.arange(len(masks)), following]
        following = np.where(is_available, following, np.argmax(masks, axis=1))
    history: list[FloatArray] = []
    converged = False
    while len(history) < max_iterations and not converged:
        weights = batch.solve(following)
        converged = bool(history) and bool(np.abs(weights - history[-1]).max() < tolerance)
        history.append(weights)
        following = _greedy(batch.next_x @ weights, masks)
    return LeastSquaresPolicy(np.array(history), converged, discount, features, action_mask)


def _greedy(values: FloatArray, masks: NDArray[np.bool_] | None) -> NDArray[np.int64]:
    """Returns the available action with the largest value in each row of (n, actions) values."""
    chosen: NDArray[np.int64] = np.argmax(values if masks is None else np.where(masks, values, -np.inf), axis=1)
    return chosen


def _next_masks(action_mask: Callable[[Any], Any] | None, transitions: Transitions) -> NDArray[np.bool_] | None:
    """Returns the available actions of each next state, (n, actions), all in terminal states; None without masks.

    Raises:
        TypeError: if ``action_mask`` is not a function, or returns something other than booleans or integers.
        ValueError: if it returns masks that do not fit the actions, or is missing for the episodes of a masked run.
    """
    if action_mask is None:
        if transitions.masked:
            raise ValueError(
                "action_mask must be a function from an observation to its mask, since the recorded run had action "
                "masks, got None"
            )
        return None
    if not callable(action_mask):
        raise TypeError(f"action_mask must be a function from an observation to its mask, got {shown(action_mask)}")
    masks = np.ones((len(transitions), transitions.n_actions), np.bool_)
    goes_on = ~transitions.terminated
    masks[goes_on] = _masks(action_mask, transitions.next_observations[goes_on], transitions.n_actions)
    return masks


def _masks(action_mask: Callable[[Any], Any], observations: NDArray[Any], n_actions: int) -> NDArray[np.bool_]:
    """Returns the masks of n observations, (n, actions)."""
    found = [checked_mask("action_mask", action_mask(one), n_actions) for one in each(observations)]
    return np.array(found, np.bool_).reshape(-1, n_actions)
