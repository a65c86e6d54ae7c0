"""Least-squares TD: the weights that are the fixed point of TD on all transitions seen so far."""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab._utils.arrays import numbers
from qtab._utils.memory import check_memory
from qtab._utils.shown import counted

FloatArray = NDArray[np.float64]

MATRICES = 3
"""The number of (d, d) arrays that exist at the same time."""
_SINGULAR = "A is singular after these transitions; another epsilon helps"


class LSTD:
    """LSTD(λ): w = A⁻¹ b with A = εI + Σ z (x - γ x')ᵀ and b = Σ R z over all steps, z = γλ z + x.

    Sutton & Barto, 2nd ed., section 9.8, equations 9.20 to 9.22, for λ = 0; J. Boyan, "Technical update: least-squares
    temporal difference learning", Machine Learning 49, 2002, for traces. It runs in NumPy.

    Args:
        n_features: d, the number of features.
        discount: γ, in [0, 1].
        trace_decay: λ, in [0, 1].
        epsilon: ε, above 0: A begins as ε times the identity. A large value holds the weights near zero at first; with
            a tiny one early weights vary widely.
        recursive: Whether each step updates A⁻¹ by the Sherman-Morrison formula (eq. 9.22), with a cost of d² per step,
            or A is kept and the equations are solved when the weights are read, with a cost of d³. The weights agree up
            to rounding errors, which grow in the first case as ε becomes smaller.

    Raises:
        MemoryError: if the matrices would take more than half of the machine's memory, or more than is free.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    def __init__(
        self,
        n_features: int,
        discount: float = 1.0,
        *,
        trace_decay: float = 0.0,
        epsilon: float = 1e-3,
        recursive: bool = True,
    ) -> None:
        count = checks.integer("n_features", n_features, least=1)
        self.discount = checks.real("discount", discount, 0.0, 1.0)
        self.trace_decay = checks.real("trace_decay", trace_decay, 0.0, 1.0)
        self.recursive = checks.boolean("recursive", recursive)
        self.epsilon = checked_epsilon("epsilon", epsilon, recursive=self.recursive)
        check_memory(f"matrices of {count:,} x {count:,} numbers for {count:,} features", 8 * MATRICES * count**2)
        scale = 1.0 / self.epsilon if self.recursive else self.epsilon
        self._matrix = scale * np.eye(count)  # A⁻¹ if recursive, else A
        self._b, self._trace = np.zeros(count), np.zeros(count)

    @property
    def weights(self) -> FloatArray:
        """(d,): the weights w = A⁻¹ b.

        Raises:
            ValueError: if A is singular, or if numbers overflowed.
        """
        weights = _product(self._matrix, self._b) if self.recursive else _solution(self._matrix, self._b)
        if not np.isfinite(weights).all():
            raise ValueError("the weights are not finite: A is singular, or numbers overflowed; another epsilon helps")
        return weights

    @property
    def b(self) -> FloatArray:
        """(d,): b, the sum of all rewards times the traces."""
        return self._b.copy()

    def start_episode(self) -> None:
        """Begins an episode: the trace becomes zero. Without traces it has no effect."""
        self._trace[:] = 0.0

    def update(self, features: ArrayLike, reward: float, next_features: ArrayLike, *, terminated: bool = False) -> None:
        """Learns from a transition; call :meth:`start_episode` before the first one of each episode.

        Args:
            features: (d,): x, the features of the state.
            reward: R.
            next_features: (d,): x', the features of the next state.
            terminated: Whether the next state is terminal, so that its value is zero.

        Raises:
            TypeError: for an argument of the wrong type.
            ValueError: for another number of features, or a number that is not finite; if recursive, also if A would
                be singular. The transition is then not learned.
        """
        x, next_x = self._vector("features", features), self._vector("next_features", next_features)
        self._learn(x, checks.finite("reward", reward), next_x, checks.boolean("terminated", terminated))

    def learn_episode(self, features: ArrayLike, rewards: ArrayLike, *, terminated: bool = True) -> None:
        """Learns from an episode.

        Args:
            features: (steps + 1, d): the features of its states, from the first one to the last one.
            rewards: (steps,): its rewards.
            terminated: Whether the last state is terminal, so that its value is zero; if not, the episode was
                truncated.

        Raises:
            TypeError: for an argument of the wrong type.
            ValueError: for another shape, or a number that is not finite; if recursive, also if A would be singular.
                The transitions before that one are then learned.
        """
        matrix, given = numbers("features", features), numbers("rewards", rewards)
        if given.ndim != 1 or matrix.shape != (len(given) + 1, len(self._b)):
            raise ValueError(
                f"features must have the shape (steps + 1, {len(self._b)}) and rewards (steps,), got {matrix.shape} "
                f"and {given.shape}"
            )
        ends = checks.boolean("terminated", terminated)
        self.start_episode()
        for step, reward in enumerate(given.tolist()):
            self._learn(matrix[step], reward, matrix[step + 1], ends and step == len(given) - 1)

    def _learn(self, x: FloatArray, reward: float, next_x: FloatArray, terminated: bool) -> None:
        z = self._trace * (self.discount * self.trace_decay) + x
        difference = x if terminated else x - self.discount * next_x
        if self.recursive:
            v = _product(self._matrix.T, difference)
            along = _product(self._matrix, z)
            denominator = 1.0 + _product(v[None], z)[0]
            if denominator == 0.0:  # by which the determinant of A is multiplied
                raise ValueError(_SINGULAR)
            self._matrix -= along[:, None] * v / denominator
        else:
            self._matrix += z[:, None] * difference
        self._b += reward * z
        self._trace = z

    def _vector(self, name: str, values: ArrayLike) -> FloatArray:
        vector = numbers(name, values)
        if vector.shape != self._b.shape:
            raise ValueError(f"{name} must have the shape {self._b.shape}, got {vector.shape}")
        return vector

    def __repr__(self) -> str:
        """One line with the settings."""
        return (
            f"<LSTD of {counted(len(self._b), 'feature')}: discount {self.discount:g}, λ = {self.trace_decay:g}, "
            f"ε = {self.epsilon:g}>"
        )


def checked_epsilon(name: str, value: Any, *, recursive: bool = True) -> float:
    """Returns ε as a float.

    Raises:
        TypeError: if it is not a number.
        ValueError: if it is not finite and above 0 or, if recursive, its reciprocal is infinite.
    """
    epsilon = checks.finite(name, value)
    if epsilon <= 0.0:
        raise ValueError(f"{name} must be above 0, got {epsilon:g}")
    if recursive and not math.isfinite(1.0 / epsilon):
        raise ValueError(f"{name} must have a finite reciprocal if recursive, got {epsilon:g}")
    return epsilon


def _product(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    """Returns the product of a matrix and a vector, added from left to right, so that the bits are always the same."""
    total: FloatArray = matrix[:, 0] * vector[0]
    for column in range(1, len(vector)):
        total += matrix[:, column] * vector[column]
    return total


def _solution(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    """Returns x with matrix x = vector, by Gaussian elimination with partial pivoting.

    The bits are always the same, unlike those of ``np.linalg.solve``.

    Raises:
        ValueError: if the matrix is singular.
    """
    rows, b = matrix.copy(), vector.copy()
    with np.errstate(all="ignore"):  # the caller checks the numbers
        for column in range(len(b)):
            pivot = column + int(np.argmax(np.abs(rows[column:, column])))
            if rows[pivot, column] == 0.0:
                raise ValueError(_SINGULAR)
            rows[[column, pivot]], b[[column, pivot]] = rows[[pivot, column]], b[[pivot, column]]
            factors = rows[column + 1 :, column] / rows[column, column]
            rows[column + 1 :, column:] -= factors[:, None] * rows[column, column:]
            b[column + 1 :] -= factors * b[column]
        solution = np.empty_like(b)
        for column in reversed(range(len(b))):
            solution[column] = b[column] / rows[column, column]
            b[:column] -= rows[:column, column] * solution[column]
    return solution
