"""Least-squares TD: the weights that are the fixed point of TD on all transitions seen so far."""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab._utils.arrays import numbers
from qtab._utils.shown import counted

FloatArray = NDArray[np.float64]

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
        self.epsilon = checks.finite("epsilon", epsilon)
        if self.epsilon <= 0.0:
            raise ValueError(f"epsilon must be above 0, got {self.epsilon:g}")
        self.recursive = checks.boolean("recursive", recursive)
        scale = 1.0 / self.epsilon if self.recursive else self.epsilon
        if not math.isfinite(scale):
            raise ValueError(f"epsilon must have a finite reciprocal if recursive, got {self.epsilon:g}")
        self._matrix = scale * np.eye(count)  # A⁻¹ if recursive, else A
        self._b, self._trace = np.zeros(count), np.zeros(count)

    @property
    def weights(self) -> FloatArray:
        """(d,): the weights w = A⁻¹ b.

        Raises:
            ValueError: if A is singular, or if numbers overflowed.
        """
        try:
            weights: NDArray[Any] = (
                _product(self._matrix, self._b) if self.recursive else np.linalg.solve(self._matrix, self._b)
            )
        except np.linalg.LinAlgError:
            raise ValueError(_SINGULAR) from None
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


def _product(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    """Returns the product of a matrix and a vector, added from left to right, so that the bits are always the same."""
    total: FloatArray = matrix[:, 0] * vector[0]
    for column in range(1, len(vector)):
        total += matrix[:, column] * vector[column]
    return total
