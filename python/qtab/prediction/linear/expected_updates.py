"""The weights of methods that make their expected update in every step, as if all states were updated at once."""

from collections.abc import Callable
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from qtab._utils import checks
from qtab._utils.arrays import numbers
from qtab._utils.memory import check_memory
from qtab._utils.shown import counted
from qtab.prediction.linear.chain import FloatArray
from qtab.prediction.linear.geometry import LinearGeometry

ExpectedMethod: TypeAlias = Literal["td", "gtd2", "tdc", "emphatic_td"]
EXPECTED_METHODS: tuple[str, ...] = get_args(ExpectedMethod)
WITH_SECOND_WEIGHTS = ("gtd2", "tdc")
"""The methods with a second weight vector v."""


def expected_updates(
    geometry: LinearGeometry,
    method: ExpectedMethod,
    updates: int,
    learning_rate: float,
    *,
    second_learning_rate: float | None = None,
    initial_weights: ArrayLike | None = None,
) -> FloatArray:
    """Returns the weights after each expected update of a method, (updates + 1, d) float64, the initial weights first.

    The expectation is over the states under the distribution of ``geometry``, the actions of the policy, and the next
    states. In a sampled off-policy method, importance sampling ratios have the same effect.

    Args:
        geometry: The transition table, the features, and the distribution, from
            :func:`qtab.prediction.linear_geometry`.
        method: ``"td"``: semi-gradient TD(λ), which for λ = 0 and equally likely states is semi-gradient DP (Sutton &
            Barto, 2nd ed., eq. 11.9); for λ = 0 also ``"gtd2"`` and ``"tdc"`` (section 11.7) and ``"emphatic_td"``
            (section 11.8), with an interest of 1 in every state.
        updates: The number of updates.
        learning_rate: α, the step size of the weights.
        second_learning_rate: β, the step size of the second weight vector of ``"gtd2"`` and ``"tdc"``, which is zero at
            first.
        initial_weights: (d,): the weights before the first update; None means zero.

    Raises:
        MemoryError: if the weights would take more than half of the machine's memory, or more than is free.
        OverflowError: if the weights exceed the range of float64.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range or that does not apply to the method.
    """
    checks.choice("method", method, EXPECTED_METHODS)
    updates = checks.count("updates", updates, least=0)
    alpha = checks.finite("learning_rate", learning_rate)
    if (second_learning_rate is not None) != (method in WITH_SECOND_WEIGHTS):
        needed = "must be given" if second_learning_rate is None else "must be None"
        raise ValueError(f"second_learning_rate {needed} for method {method!r}")
    beta = 0.0 if second_learning_rate is None else checks.finite("second_learning_rate", second_learning_rate)
    if method != "td" and geometry.trace_decay > 0.0:
        raise ValueError(f"trace_decay must be 0 for method {method!r}, got {geometry.trace_decay:g}")
    count = geometry.features.shape[1]
    w = np.zeros(count) if initial_weights is None else numbers("initial_weights", initial_weights).copy()
    if w.shape != (count,):
        raise ValueError(f"initial_weights must have {count} numbers, one for each feature, got shape {w.shape}")
    check_memory(f"the weights of {counted(updates, 'update')}", 8 * (updates + 1) * count)
    weights = np.empty((updates + 1, count))
    weights[0] = w
    step = _STEPS[method](geometry, alpha, beta)
    with np.errstate(over="ignore", invalid="ignore"):
        for update in range(updates):
            weights[update + 1] = w = step(w)
    if not np.isfinite(weights).all():
        first = int(np.flatnonzero(~np.isfinite(weights).all(axis=1))[0])
        raise OverflowError(f"the weights overflow in update {first}; a smaller learning_rate may prevent it")
    return weights


Step: TypeAlias = Callable[[FloatArray], FloatArray]


def _td(geometry: LinearGeometry, alpha: float, beta: float) -> Step:  # noqa: ARG001 - as the others
    """W <- w + α E[δ x] = w + α (b - A w)."""

    def step(w: FloatArray) -> FloatArray:
        return w + alpha * (geometry.b - geometry.A @ w)

    return step


def _gtd2(geometry: LinearGeometry, alpha: float, beta: float) -> Step:
    """W <- w + α E[(x - γ x') xᵀ] v = w + α Aᵀ v, with the v of TDC."""
    covariance = _covariance(geometry)
    v = np.zeros(len(geometry.b))

    def step(w: FloatArray) -> FloatArray:
        moved = w + alpha * (geometry.A.T @ v)
        v[:] += beta * (geometry.b - geometry.A @ w - covariance @ v)
        return moved

    return step


def _tdc(geometry: LinearGeometry, alpha: float, beta: float) -> Step:
    """W <- w + α (E[δ x] - γ E[x' xᵀ] v), v <- v + β (E[δ x] - E[x xᵀ] v), both with the old w and v."""
    covariance = _covariance(geometry)
    v = np.zeros(len(geometry.b))

    def step(w: FloatArray) -> FloatArray:
        error = geometry.b - geometry.A @ w
        # A is E[x (x - γ x')ᵀ].
        moved = w + alpha * (error - (covariance - geometry.A.T) @ v)
        v[:] += beta * (error - covariance @ v)
        return moved

    return step


def _emphatic_td(geometry: LinearGeometry, alpha: float, beta: float) -> Step:  # noqa: ARG001 - as the others
    """W <- w + α Σ f(s) δ(s) x(s) with the expected emphases f <- μ + γ Pᵀ f, f = 0 before the first step.

    f(s) is the expectation of M in state s times the probability of s.
    """
    emphasis = np.zeros(len(geometry.values))

    def step(w: FloatArray) -> FloatArray:
        emphasis[:] = geometry.distribution + geometry.discount * (geometry.transition_matrix.T @ emphasis)
        moved: FloatArray = w + alpha * (geometry.features.T @ (emphasis * geometry.bellman_errors(w)))
        return moved

    return step


def _covariance(geometry: LinearGeometry) -> FloatArray:
    """(d, d): E[x xᵀ]."""
    matrix: FloatArray = geometry.features.T @ (geometry.distribution[:, None] * geometry.features)
    return matrix


_STEPS = {"td": _td, "gtd2": _gtd2, "tdc": _tdc, "emphatic_td": _emphatic_td}
