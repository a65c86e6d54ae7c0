"""LSTDQ: the linear action values of a policy, from a batch of transitions of any other policy."""

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab._utils.arrays import numbers
from qtab._utils.shown import shown
from qtab.discretizers import Discretizer
from qtab.planning.least_squares.equations import Batch, FloatArray
from qtab.planning.least_squares.transitions import Transitions

GivenFeatures: TypeAlias = ArrayLike | Callable[[Any], Any]
"""The accepted forms of features: an array, or a function from an observation to its feature vector."""
GivenActions: TypeAlias = ArrayLike | Callable[[Any], Any]
"""The accepted forms of a policy; see :func:`chosen_actions`."""


def lstdq(
    transitions: Transitions,
    features: GivenFeatures,
    policy: GivenActions,
    discount: float,
    *,
    epsilon: float = 0.0,
) -> FloatArray:
    """Returns the weights of a policy's action values q(s, a) = x(s) · w_a, (d, actions) float64.

    They are the fixed point of TD on the transitions, which can come from any other policy: w = A⁻¹ b with
    A = εI + Σ φ(S, a) (φ(S, a) - γ φ(S', π(S')))ᵀ and b = Σ R φ(S, a), where φ(s, a) is x(s) in the block of the action
    a, and zero elsewhere. M. Lagoudakis and R. Parr, "Least-squares policy iteration", Journal of Machine Learning
    Research 4, 2003.

    It runs in NumPy, in a time that grows with the cube of d * actions, and with memory for its square: 1,000 weights
    take less than a second. If the policy uses at most half of the weights in the next states, as with a
    feature for each state, the time grows with the cube of their number and of d instead.

    Args:
        transitions: The transitions.
        features: x(s): (states, d) or (*cells, d) numbers, the feature vector of each observation that is an integer or
            a few of them, counted from 0; or a function from an observation to (d,) numbers, such as
            ``run.discretizer.feature_values`` of a run with a Fourier basis.
        policy: The action in each state, counted from 0: a single one; (states,) or (*cells,) integers; or a function
            from an observation to an action.
        discount: The discount γ, in [0, 1].
        epsilon: ε, at least 0: A begins as ε times the identity. A small ε keeps weights that the transitions do
            not determine near zero.

    Raises:
        MemoryError: if the matrices would take more than half of the machine's memory, or more than is free.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, features or a policy that do not fit the observations, or if A is
            singular, with the features whose weights are not determined.
    """
    discount, epsilon = checks.real("discount", discount, 0.0, 1.0), checked_epsilon(epsilon)
    batch = batch_of(transitions, features, discount, epsilon)
    return batch.solve(chosen_actions("policy", policy, transitions))


def checked_epsilon(epsilon: float) -> float:
    """Returns ε as a float.

    Raises:
        TypeError: if it is not a number.
        ValueError: if it is negative or not finite.
    """
    checked = checks.finite("epsilon", epsilon)
    if checked < 0.0:
        raise ValueError(f"epsilon must be at least 0, got {checked:g}")
    return checked


def batch_of(transitions: Transitions, features: GivenFeatures, discount: float, epsilon: float) -> Batch:
    """Returns transitions with their feature vectors: the equations with a discount γ and ε.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for features that do not fit the observations.
    """
    checks.instance("transitions", transitions, Transitions)
    x = feature_vectors(features, transitions.observations)
    next_x = np.zeros_like(x)
    goes_on = ~transitions.terminated
    if goes_on.any():
        following = feature_vectors(features, transitions.next_observations[goes_on])
        if following.shape[1:] != x.shape[1:]:
            raise ValueError(f"features must return as many numbers each time, got {x.shape[1]} and {len(following.T)}")
        next_x[goes_on] = following
    return Batch(transitions, x, next_x, discount, epsilon)


def feature_vectors(features: GivenFeatures, observations: NDArray[Any]) -> FloatArray:
    """Returns the feature vectors of observations, (n, d) float64; see :func:`lstdq`.

    Raises:
        TypeError: if the features are not numbers, an array is given for observations that are not integers, or a
            discretizer or its rows are given.
        ValueError: for another shape, or a number that is not finite.
    """
    check_vectors(features)
    if callable(features):
        try:
            given: Any = np.array([features(one) for one in each(observations)])
        except ValueError as error:
            if "inhomogeneous" not in str(error):
                raise
            raise ValueError("features must return as many numbers each time") from None
        vectors = numbers("features", given)
        if vectors.ndim != 2:
            raise ValueError(f"features must return a vector (d,), got shape {vectors.shape[1:]}")
        return vectors
    vectors = _looked_up("features", numbers("features", features), observations, axes=1)
    return np.ascontiguousarray(vectors)


def check_vectors(features: Any) -> None:
    """Checks that features are not a discretizer, or its row numbers, which would be taken for feature vectors.

    Raises:
        TypeError: if they are.
    """
    owner = getattr(features, "__self__", features)
    if not isinstance(owner, Discretizer):
        return
    is_weighted = hasattr(owner, "feature_values")
    if features is owner or not is_weighted:
        hint = (
            "pass its method feature_values"
            if is_weighted
            else "return a vector that is 1 at its active_rows and 0 elsewhere"
        )
        raise TypeError(f"features must be an array or a function that returns vectors, got {owner!r}; {hint}")


def chosen_actions(name: str, policy: GivenActions, transitions: Transitions) -> NDArray[np.int64]:
    """Returns the action of a policy in each next state, (n,); 0 in terminal states, whose values are zero.

    Raises:
        TypeError: if the actions are not integers.
        ValueError: for a policy that does not fit the observations, or an action that does not exist.
    """
    goes_on, count = ~transitions.terminated, transitions.n_actions
    chosen = np.zeros(len(transitions), np.int64)
    following = transitions.next_observations[goes_on]
    if callable(policy):
        found = np.array([policy(one) for one in each(following)] or [0])
    elif np.ndim(policy) == 0:
        found = np.array(policy)
    else:
        found = _looked_up(name, np.asarray(policy), following, axes=0)
    if found.dtype.kind not in "iu":
        raise TypeError(f"{name} must be the number of an action in each state, got {shown(policy)}")
    wrong = (found < 0) | (found >= count)
    if wrong.any():
        raise ValueError(
            f"{name} must be actions from 0 to {count - 1}, got {np.atleast_1d(found)[np.atleast_1d(wrong)][0]}"
        )
    chosen[goes_on] = found[: len(following)] if found.ndim else found
    return chosen


def each(observations: NDArray[Any]) -> Sequence[Any]:
    """Returns observations one by one: Python's numbers, or arrays."""
    return observations.tolist() if observations.ndim == 1 else list(observations)


def _looked_up(name: str, table: NDArray[Any], observations: NDArray[Any], axes: int) -> NDArray[Any]:
    """Returns the items of a table for observations, which are its indices.

    Raises:
        TypeError: if observations are not integers.
        ValueError: if the table has another number of axes, or lacks an observation.
    """
    if observations.dtype.kind not in "iu":
        raise TypeError(f"{name} must be a function of the observation for observations that are not integers")
    index = observations.reshape(len(observations), -1).T
    if table.ndim != len(index) + axes:
        expected = "(states" if len(index) == 1 else "(*cells"
        raise ValueError(f"{name} must have the shape {expected}{', d' if axes else ','}), got {table.shape}")
    for numbers_of, size in zip(index, table.shape, strict=False):
        outside = numbers_of[(numbers_of < 0) | (numbers_of >= size)]
        if len(outside):
            raise ValueError(f"{name} must have an item for each observation, got {size} and observation {outside[0]}")
    items: NDArray[Any] = table[tuple(index)]
    return items
