"""A row of the table for each observation of a discrete space."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._discretizer_spec import IdentitySpec
from qtab.config import Config
from qtab.discretizers.base import Discretizer, check_table_size
from qtab.discretizers.refusals import too_large


@dataclass(frozen=True, eq=False, repr=False)
class Identity(Discretizer):
    """Integers from ``low`` to ``high``, both int64; each combination is a cell, numbered in C order."""

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
        return cls(low, high)

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "Identity":  # noqa: ARG003
        """Returns the cells of a saved run; see :meth:`Discretizer.restore`."""
        low, high = arrays["low"], arrays["high"]
        if low.dtype != np.int64 or high.dtype != np.int64:
            raise ValueError("its bounds are not those of a space")
        if low.shape != high.shape or low.ndim > 1 or (low > high).any():
            raise ValueError("its bounds are not those of a discrete space")
        return cls(low, high)

    @cached_property  # a call of train() asks seven times
    def shape(self) -> tuple[int, ...]:
        """How many integers each component takes."""
        return tuple(np.ravel(self.high - self.low + 1).tolist())

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the numbers halfway between the integers."""
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
