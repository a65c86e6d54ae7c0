"""A row of the table for each observation of a discrete space."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._spec import IdentitySpec
from qtab.config import Config
from qtab.discretizers.base import Discretizer, check_table_size
from qtab.discretizers.part import too_large

_IS_TUPLE = "is_tuple"
"""The name in files of :attr:`Identity.is_tuple`."""


@dataclass(frozen=True, eq=False, repr=False)
class Identity(Discretizer):
    """Integers from ``low`` to ``high``, both int64; each combination is a cell, numbered in C order."""

    is_tuple: bool | None = False
    """Whether the space is a Tuple, for which Gymnasium batches n observations as a tuple of (n,) arrays; None if
    unknown, from a file of an earlier version."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "Identity":  # noqa: ARG003 - it has no options
        """Returns the cells of a discrete observation space.

        Raises:
            ValueError: if the space is not discrete, or the table would be too large.
        """
        return cls.of_space(space, n_actions)

    @classmethod
    def of_space(cls, space: Any, n_actions: int) -> "Identity":
        """Returns the cells of a discrete observation space; see :meth:`build`."""
        bounds = integer_bounds(space)
        if bounds is None:
            raise ValueError(
                f"the observation space must be discrete for discretizer 'identity', got {space}; discretizer 'bins' "
                "or 'tiles' divides it"
            )
        low, high = bounds
        if not low.size:
            raise ValueError(f"the observation space must have at least one component, got {space}")
        values = float(np.prod((high - low + 1).astype(np.float64))) * n_actions
        check_table_size("the observation space", space, values, too_large(()))
        return cls(low, high, isinstance(space, spaces.Tuple))

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "Identity":  # noqa: ARG003
        """Returns the cells of a saved run; see :meth:`Discretizer.restore`."""
        low, high = arrays["low"], arrays["high"]
        if low.dtype != np.int64 or high.dtype != np.int64:
            raise ValueError("its bounds are not those of a space")
        if low.shape != high.shape or low.ndim > 1 or (low > high).any():
            raise ValueError("its bounds are not those of a discrete space")
        is_tuple = arrays.get(_IS_TUPLE)
        if is_tuple is not None and (is_tuple.dtype != np.bool_ or is_tuple.shape):
            raise ValueError("its observations are not those of a space")
        return cls(low, high, (None if is_tuple is None else bool(is_tuple)) if low.ndim else False)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Returns the arrays to save."""
        known = {_IS_TUPLE: np.array(self.is_tuple)} if self.low.ndim and self.is_tuple is not None else {}
        return {**super().arrays(), **known}

    def active_rows(self, observation: Any) -> NDArray[np.int64]:
        """Returns the (1,) row of an observation, or the (n, 1) rows of n observations.

        Observations of a Tuple space are batched as in Gymnasium's vector environments, as a tuple of (n,) arrays, or
        like those of any other space, (n, d).

        Raises:
            TypeError: if the observation does not hold integers.
            ValueError: if the observation does not have the shape of the space, or has no row.
        """
        return super().active_rows(self.in_rows(observation))

    def split(self, observation: Any, count: int | None) -> list[Any]:
        """Returns a list of ``count`` observations; None means a single one."""
        rows = super().split(observation if count is None else self.in_rows(observation), count)
        return rows if count is None or not self.is_tuple else [tuple(np.asarray(row).tolist()) for row in rows]

    def in_rows(self, observation: Any) -> Any:
        """Converts a batch of a Tuple space, a tuple of (n,) arrays, into one (n, d) array.

        Any other observation is returned unchanged.

        Raises:
            ValueError: if the arrays have different lengths, or it is unknown whether the space is a Tuple.
        """
        is_tuple = self.is_tuple is not False and isinstance(observation, tuple) and len(observation) == self.low.size
        if not is_tuple or not all(isinstance(part, np.ndarray) and part.ndim == 1 for part in observation):
            return observation
        counts = {len(part) for part in observation}
        if len(counts) > 1:
            raise ValueError(
                f"observations must be batched alike in all their components, got {sorted(counts)} of them"
            )
        if self.is_tuple is None and counts == {len(observation)}:
            raise ValueError(
                f"observations must be an array of shape {(*counts, len(observation))} for a run from a file of an "
                "earlier version, which does not tell a Tuple space from a MultiDiscrete one, got a tuple of arrays"
            )
        return np.stack(observation, axis=-1)

    @cached_property  # a call of train() reads it seven times
    def shape(self) -> tuple[int, ...]:
        """The number of integers of each component."""
        return tuple(np.ravel(self.high - self.low + 1).tolist())

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the midpoints between the integers."""
        first = np.ravel(self.low).tolist()
        return tuple(low - 0.5 + np.arange(count + 1.0) for low, count in zip(first, self.shape, strict=True))

    def spec(self) -> IdentitySpec:
        """Returns the discretizer as the extension takes it."""
        return {
            "type": "identity",
            "first": np.ravel(self.low).tolist(),
            "counts": self.shape,
            "scalar": not self.low.shape,
        }


def integer_bounds(space: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """Returns the first and the last integer of each component of a discrete space; None for any other space."""
    if isinstance(space, spaces.Discrete):
        first, count = np.array(space.start, np.int64), np.array(space.n, np.int64)
    elif isinstance(space, spaces.MultiDiscrete) and space.nvec.ndim == 1:
        first, count = space.start.astype(np.int64), space.nvec.astype(np.int64)
    elif isinstance(space, spaces.Tuple) and all(isinstance(part, spaces.Discrete) for part in space) and len(space):
        parts: Any = space.spaces
        first = np.array([part.start for part in parts], np.int64)
        count = np.array([part.n for part in parts], np.int64)
    else:
        return None
    return first, first + count - 1
