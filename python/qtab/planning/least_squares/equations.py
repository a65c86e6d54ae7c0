"""The linear equations of LSTDQ, A w = b, whose solution is the weights of a policy's action values."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab._utils.linear_algebra import dependent_columns
from qtab._utils.memory import check_memory
from qtab._utils.shown import counted
from qtab.planning.least_squares.transitions import Transitions

FloatArray: TypeAlias = NDArray[np.float64]
EPS = np.finfo(np.float64).eps
MATRICES = 8
"""The number of arrays of the size of A, or of its diagonal blocks, that exist at the same time, with a margin: at most
6.7 were measured, including SciPy's copies."""


@dataclass(frozen=True, eq=False)
class Batch:
    """Transitions with their feature vectors: the equations for any policy."""

    transitions: Transitions
    x: FloatArray
    """(n, d): the features of the states."""
    next_x: FloatArray
    """(n, d): the features of the next states, zero where these are terminal."""
    discount: float
    """The discount γ."""
    epsilon: float
    """ε: A begins as ε times the identity."""

    def solve(self, next_actions: NDArray[np.int64]) -> FloatArray:
        """Returns w = A⁻¹ b as (d, actions), for the action of the policy in each next state.

        φ(s, a) is x(s) in the block of the action, so that A consists of a block for each pair of actions:
        A = D - γP. D has only the blocks of an action with itself, and does not depend on the policy. The columns of P
        are zero for features that no next state has with the action of the policy. If these are most columns, as with a
        feature for each state, w = D⁻¹(b + γPw) is first solved for the weights that P uses, and the others follow.

        Raises:
            MemoryError: if the matrices would take more than half of the machine's memory, or more than is free.
            ValueError: if A is singular up to rounding errors, or numbers overflowed.
        """
        d, k = self.x.shape[1], self.transitions.n_actions
        self._check_memory(d, k)
        is_used = np.array([(self.next_x[next_actions == action] != 0.0).any(axis=0) for action in range(k)])
        weights = None
        if 2 * is_used.sum() <= k * d and np.isfinite(self._blocks).all():
            weights = self._solved_by_blocks(next_actions, np.flatnonzero(is_used))
        if weights is None:
            weights = self._solved_at_once(next_actions)
        return weights.reshape(k, d).T

    @cached_property
    def _rows(self) -> list[NDArray[np.intp]]:
        """The transitions with each action."""
        return [np.flatnonzero(self.transitions.actions == action) for action in range(self.transitions.n_actions)]

    @cached_property
    def _blocks(self) -> FloatArray:
        """(actions, d, d): the blocks of D, without ε."""
        with np.errstate(over="ignore", invalid="ignore"):
            return np.array([self._weighted(rows).T @ self.x[rows] for rows in self._rows])

    @cached_property
    def _b(self) -> FloatArray:
        """(actions * d,): b."""
        with np.errstate(over="ignore", invalid="ignore"):
            return np.concatenate([self._weighted(rows).T @ self.transitions.rewards[rows] for rows in self._rows])

    @cached_property
    def _scale(self) -> FloatArray:
        """(actions * d,): the sizes of the features of each action, 1 for those that are always zero.

        The equations are scaled by them, since features of different sizes do not make A singular.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            squares = np.concatenate([(self._weighted(rows) * self.x[rows]).sum(axis=0) for rows in self._rows])
            sizes = np.sqrt(squares + self.epsilon)
        return np.where(sizes > 0.0, sizes, 1.0)

    def _weighted(self, rows: NDArray[np.intp]) -> FloatArray:
        weighted: FloatArray = self.transitions.weights[rows, None] * self.x[rows]
        return weighted

    def _check_memory(self, size: int, blocks: int = 1) -> None:
        """Raises an error if matrices that consist of so many square blocks do not fit into memory."""
        d, k = self.x.shape[1], self.transitions.n_actions
        what = f"matrices of {size:,} x {size:,} numbers for {counted(d, 'feature')} of {counted(k, 'action')}"
        check_memory(what, 8 * MATRICES * blocks * size**2)

    def _solved_at_once(self, next_actions: NDArray[np.int64]) -> FloatArray:
        """Returns w from the whole of A, (actions * d,)."""
        d, k = self.x.shape[1], self.transitions.n_actions
        self._check_memory(k * d)
        blocks = np.zeros((k, d, k, d))
        with np.errstate(over="ignore", invalid="ignore"):
            for action, rows in enumerate(self._rows):
                z, next_x = self._weighted(rows), self.next_x[rows]
                blocks[action, :, action] += self._blocks[action]
                for following in range(k):
                    chosen = next_actions[rows] == following
                    blocks[action, :, following] -= self.discount * (z[chosen].T @ next_x[chosen])
        A = blocks.reshape(k * d, k * d) + self.epsilon * np.eye(k * d)  # noqa: N806 - the paper's symbol
        if not all(np.isfinite(array).all() for array in (A, self._b, self._scale)):
            raise ValueError("features and rewards must be smaller: their products exceed the range of float64")
        scaled = A / self._scale / self._scale[:, None]
        if not _condition(scaled) * k * d * EPS < 1.0:
            raise self._singular(scaled)
        weights: FloatArray = np.linalg.solve(scaled, self._b / self._scale) / self._scale
        return weights

    @cached_property
    def _scaled_blocks(self) -> FloatArray:
        """(actions, d, d): the scaled blocks of D.

        Raises:
            ValueError: if a feature is always zero for an action, so that A is singular.
        """
        d, k = self.x.shape[1], self.transitions.n_actions
        scale = self._scale.reshape(k, d)
        scaled = (self._blocks + self.epsilon * np.eye(d)) / scale[:, None, :] / scale[:, :, None]
        if not np.diagonal(scaled, axis1=1, axis2=2).all():
            raise self._singular(scaled)
        return scaled

    @cached_property
    def _condition_of_blocks(self) -> float:
        """The largest condition number of the scaled blocks of D."""
        return max(map(_condition, self._scaled_blocks))

    def _solved_by_blocks(self, next_actions: NDArray[np.int64], used: NDArray[np.intp]) -> FloatArray | None:
        """Returns w, (actions * d,), from D and the given columns of P; None if this is too inexact."""
        d, k = self.x.shape[1], self.transitions.n_actions
        scale, column_actions = self._scale, used // d
        b, P = self._b / scale, np.zeros((k * d, len(used)))  # noqa: N806 - the symbol of the equations
        with np.errstate(over="ignore", invalid="ignore"):
            for action, rows in enumerate(self._rows):
                chosen = next_actions[rows, None] == column_actions
                next_x = np.where(chosen, self.next_x[np.ix_(rows, used % d)], 0.0)
                P[action * d : (action + 1) * d] = self._weighted(rows).T @ next_x
            P /= scale[:, None] * scale[used]  # noqa: N806
        if not (np.isfinite(P).all() and np.isfinite(b).all()):
            return None
        rounding = k * d * EPS
        if not self._condition_of_blocks * rounding < 1.0:
            return None
        given = np.column_stack([b, self.discount * P]).reshape(k, d, -1)
        by_blocks = np.concatenate([np.linalg.solve(*pair) for pair in zip(self._scaled_blocks, given, strict=True)])
        of_b, of_P = by_blocks[:, 0], by_blocks[:, 1:]  # noqa: N806
        reduced = np.eye(len(used)) - of_P[used]
        of_reduced = _condition(reduced, 1.0 + np.linalg.norm(of_P[used], 1)) if len(used) else 1.0
        if not self._condition_of_blocks * of_reduced * rounding < 1.0:
            return None
        weights: FloatArray = (of_b + of_P @ np.linalg.solve(reduced, of_b[used])) / scale
        return weights

    def _singular(self, scaled: FloatArray) -> ValueError:
        """Returns the error for a singular matrix: (actions * d, actions * d), or the blocks of D."""
        d = self.x.shape[1]
        if scaled.ndim == 3:
            columns = [a * d + column for a, block in enumerate(scaled) for column in dependent_columns(block)]
        else:
            columns = list(dependent_columns(scaled))
        advice = "set epsilon above 0" if self.epsilon == 0.0 else f"set epsilon to a value other than {self.epsilon:g}"
        return ValueError(
            "features must determine all weights, but A is singular: the transitions leave open "
            f"{self._undetermined(columns)}; {advice}, or use more transitions or fewer features"
        )

    def _undetermined(self, columns: Sequence[int]) -> str:
        """Describes the weights in given columns of A."""
        d = self.x.shape[1]
        open_ones = {column // d for column in columns}
        never = [action for action in sorted(open_ones) if action not in self.transitions.actions]
        if never:
            return f"the weights of action {never[0]}, which is never taken"
        if not columns:
            return "all weights"
        action = columns[0] // d
        of_action = [column - action * d for column in columns if column // d == action]
        listed = ", ".join(map(str, of_action[:8])) + (", ..." if len(of_action) > 8 else "")
        return f"the weights of features {listed} of action {action}"


def _condition(matrix: FloatArray, norm: np.floating[Any] | None = None) -> float:
    """Returns the condition number of a matrix in the 1-norm, infinity if it is singular.

    Args:
        matrix: The matrix.
        norm: The norm of the terms whose difference the matrix is; None for that of the matrix.
    """
    try:
        norm_of_inverse = np.linalg.norm(np.linalg.inv(matrix), 1)
    except np.linalg.LinAlgError:
        return np.inf
    return float(norm_of_inverse * (np.linalg.norm(matrix, 1) if norm is None else norm))
