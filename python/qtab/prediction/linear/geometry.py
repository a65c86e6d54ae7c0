"""The fixed point of TD and the errors of linear values, computed exactly."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks, html
from qtab._utils.arrays import numbers
from qtab._utils.fields import with_fields
from qtab._utils.linear_algebra import dependent_columns
from qtab._utils.shown import counted
from qtab.prediction.linear.chain import Chain

FloatArray: TypeAlias = NDArray[np.float64]
Objective: TypeAlias = Literal["value_error", "bellman_error", "projected_bellman_error", "td_error"]
OBJECTIVES: tuple[str, ...] = get_args(Objective)
"""The errors that can be minimized."""


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class LinearGeometry:
    """The errors of the values v(s) = w · x(s) of a policy, and the weights w that minimize them.

    Sutton & Barto, 2nd ed., sections 9.4 and 11.4 to 11.6. The errors are means of squares under the distribution μ of
    the states. Weights are (d,), or (..., d) for several at once.
    """

    env: str
    """The environment's id, or the name of its class."""
    discount: float
    """The discount γ."""
    trace_decay: float
    """λ: the Bellman operator of the errors, and with it the fixed point of TD, are those of TD(λ)."""
    features: FloatArray
    """(states, d): the matrix X of the feature vectors."""
    distribution: FloatArray
    """(states,): μ, the weight of each state in the errors."""
    values: FloatArray
    """(states,): the exact values of the policy."""
    chain: Chain = field(repr=False)
    """The transitions under the policy."""

    @property
    def transition_matrix(self) -> FloatArray:
        """(states, states): P, the probability of each next state; a row sums to less than 1 where episodes may end."""
        return self.chain.matrix

    @property
    def rewards(self) -> FloatArray:
        """(states,): r, the expected reward of a step from each state."""
        return self.chain.rewards

    @cached_property
    def projection(self) -> FloatArray:
        """(states, states): Π = X (XᵀDX)⁻¹ XᵀD, which projects values to those of weights (eq. 11.14).

        The pseudoinverse replaces the inverse for linearly dependent features, as in the book.
        """
        root = np.sqrt(self.distribution)
        # X (D^½ X)⁺ D^½ is the same, without squaring the condition of X.
        projection: FloatArray = self.features @ np.linalg.pinv(root[:, None] * self.features) * root
        return projection

    @cached_property
    def A(self) -> FloatArray:  # noqa: N802 - the book's name
        """(d, d): A = XᵀD (I - γλP)⁻¹ (I - γP) X of the expected update of TD(λ), b - A w (eqs. 9.11 and 12.7)."""
        matrix: FloatArray = self.features.T @ (self.distribution[:, None] * self._slopes)
        return matrix

    @cached_property
    def b(self) -> FloatArray:
        """(d,): b = XᵀD (I - γλP)⁻¹ r of the expected update of TD(λ)."""
        vector: FloatArray = self.features.T @ (self.distribution * self._offsets)
        return vector

    @cached_property
    def td_fixed_point(self) -> FloatArray:
        """(d,): the weights w = A⁻¹ b, where the expected update of TD(λ) and the projected Bellman error are zero.

        Equation 9.12.

        Raises:
            ValueError: if the features are linearly dependent, or A is singular.
        """
        self._check_independent(self.features, "features")
        if len(dependent_columns(self.A)):
            raise ValueError(
                "the expected update of TD must have one fixed point: with this distribution, A is singular"
            )
        weights: NDArray[Any] = np.linalg.solve(self.A, self.b)
        return weights

    def minimizer(self, objective: Objective) -> FloatArray:
        """Returns the weights, (d,), that minimize an error.

        Args:
            objective: The name of the error: ``"value_error"``, ``"bellman_error"``, ``"td_error"``, or
                ``"projected_bellman_error"``, whose minimizer is :attr:`td_fixed_point`.

        Raises:
            ValueError: for another name, or if several weights minimize the error, with the numbers of the linearly
                dependent features.
        """
        checks.choice("objective", objective, OBJECTIVES)
        if objective == "projected_bellman_error":
            return self.td_fixed_point
        self._check_independent(self.features, "features")
        if objective == "value_error":
            return _least_squares(self.distribution, self.features, self.values)
        if objective == "bellman_error":
            self._check_independent(self._slopes, "features minus those of the next state")
            return _least_squares(self.distribution, self._slopes, self._offsets)
        weights, slopes, rewards = self._td_errors
        return _least_squares(weights, slopes, rewards)

    def values_of(self, weights: ArrayLike) -> FloatArray:
        """Returns (..., states): the values w · x(s).

        Raises:
            TypeError: if the weights are not numbers.
            ValueError: if their number is not that of the features.
        """
        values: FloatArray = self._checked(weights) @ self.features.T
        return values

    def bellman_errors(self, weights: ArrayLike) -> FloatArray:
        """Returns (..., states): the Bellman error vector of weights (eqs. 11.17 and 11.18), or that of TD(λ).

        Raises:
            TypeError: if the weights are not numbers.
            ValueError: if their number is not that of the features.
        """
        errors: FloatArray = self._offsets - self._checked(weights) @ self._slopes.T
        return errors

    def value_error(self, weights: ArrayLike) -> FloatArray:
        """Returns (...): the mean square value error VE of weights (eq. 9.1)."""
        return _mean_square(self.distribution, self.values - self.values_of(weights))

    def bellman_error(self, weights: ArrayLike) -> FloatArray:
        """Returns (...): the mean square Bellman error BE of weights (eq. 11.19)."""
        return _mean_square(self.distribution, self.bellman_errors(weights))

    def projected_bellman_error(self, weights: ArrayLike) -> FloatArray:
        """Returns (...): the mean square projected Bellman error PBE of weights (eq. 11.22)."""
        return _mean_square(self.distribution, self.bellman_errors(weights) @ self.projection.T)

    def td_error(self, weights: ArrayLike) -> FloatArray:
        """Returns (...): the mean square TD error TDE of weights (section 11.5), of one-step TD for every λ."""
        probability, slopes, rewards = self._td_errors
        return _mean_square(probability, rewards - self._checked(weights) @ slopes.T)

    @cached_property
    def _operator(self) -> FloatArray | None:
        """(states, states): (I - γλP)⁻¹; None for λ = 0."""
        decay = self.discount * self.trace_decay
        if decay == 0.0:
            return None
        try:
            inverse: NDArray[Any] = np.linalg.inv(np.eye(len(self.values)) - decay * self.transition_matrix)
        except np.linalg.LinAlgError:
            raise ValueError(
                "trace_decay must be below 1 without a discount if episodes from some states never end"
            ) from None
        return inverse

    @cached_property
    def _slopes(self) -> FloatArray:
        """(states, d): (I - γλP)⁻¹ (I - γP) X, by which the Bellman errors fall with the weights."""
        slopes = self.features - self.discount * (self.transition_matrix @ self.features)
        return slopes if self._operator is None else self._operator @ slopes

    @cached_property
    def _offsets(self) -> FloatArray:
        """(states,): (I - γλP)⁻¹ r, the Bellman errors of weights of zero."""
        return self.rewards if self._operator is None else self._operator @ self.rewards

    @cached_property
    def _td_errors(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The probability, x(S) - γ x(S') and the reward of each transition."""
        chain = self.chain
        following = np.where(chain.continues[:, None], self.features[chain.next_state], 0.0)
        slopes = self.features[chain.state] - self.discount * following
        return self.distribution[chain.state] * chain.probability, slopes, chain.reward

    def _checked(self, weights: ArrayLike) -> FloatArray:
        array, count = numbers("weights", weights), self.features.shape[1]
        if array.ndim == 0 or array.shape[-1] != count:
            raise ValueError(f"weights must have {count} numbers, one for each feature, got shape {array.shape}")
        return array

    def _check_independent(self, matrix: FloatArray, name: str) -> None:
        weighted = np.sqrt(self.distribution)[:, None] * matrix
        dependent = dependent_columns(weighted)
        if dependent:
            zero = [column for column in dependent if not weighted[:, column].any()]
            fault = f"{_listed(zero)} are zero there" if zero else f"{_listed(dependent)} are linearly dependent"
            raise ValueError(
                f"{name} must be linearly independent in the states that the distribution weights, or several weight "
                f"vectors are equally good: features {fault}"
            )

    def __repr__(self) -> str:
        """A one-line summary without the arrays."""
        states, count = self.features.shape
        return (
            f"<LinearGeometry of {self.env}: {counted(states, 'state')}, {counted(count, 'feature')}, discount "
            f"{self.discount:g}, λ = {self.trace_decay:g}>"
        )

    def _repr_html_(self) -> str:
        """A table and the exact values, for notebooks."""
        states, count = self.features.shape
        facts: dict[str, object] = {
            "states": states,
            "features": count,
            "discount": f"{self.discount:g}",
            "λ": f"{self.trace_decay:g}",
        }
        return html.summary(
            f"Linear values in {self.env}", facts, html.state_values("Exact values of the policy", self.values)
        )


def _listed(columns: Sequence[int]) -> str:
    """Returns the first numbers as text."""
    return ", ".join(map(str, columns[:8])) + (", ..." if len(columns) > 8 else "")


def _mean_square(weights: FloatArray, errors: FloatArray) -> FloatArray:
    """Returns Σ weights * errors² over the last axis."""
    total: FloatArray = (weights * errors**2).sum(axis=-1)
    return total


def _least_squares(weights: FloatArray, slopes: FloatArray, offsets: FloatArray) -> FloatArray:
    """Returns the w that minimizes Σ weights * (offsets - slopes w)²."""
    root = np.sqrt(weights)
    solution: NDArray[Any] = np.linalg.lstsq(root[:, None] * slopes, root * offsets, rcond=None)[0]
    return solution
