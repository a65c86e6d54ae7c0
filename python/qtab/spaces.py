"""What a learner needs to know of an environment's spaces."""

from dataclasses import dataclass
from typing import cast

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab import plan

LARGEST_TABLE = 2**32
"""Rows are numbered in 32 bits."""
FLOATS = (np.dtype(np.float32), np.dtype(np.float64))
"""The dtypes of the boxes that have a grid."""


@dataclass(frozen=True)
class Grid:
    """The article's discretizer over a Box, and the actions."""

    low: NDArray[np.floating]
    """(d,) bounds in the space's dtype."""
    high: NDArray[np.floating]
    """(d,)"""
    scale: NDArray[np.float64]
    """(d,) cells per unit."""
    actions: int
    first_action: int

    @property
    def shape(self) -> tuple[int, ...]:
        """Cells along each axis, then the actions: the shape of the Q table."""
        cells = np.round((self.high - self.low) * self.scale, 0).astype(int) + 1
        return (*(int(count) for count in cells), self.actions)

    @property
    def rows(self) -> int:
        """How many rows the table has."""
        return int(np.prod(self.shape[:-1]))

    def lit(self, observation: NDArray[np.floating]) -> list[int]:
        """Returns the rows of an observation: one.

        Raises:
            ValueError: if the observation lies outside the space.
        """
        return [int(np.ravel_multi_index(self.cell(observation), self.shape[:-1]))]

    def plan(self) -> plan.Rounding:
        """Returns it as the extension module takes it."""
        return {"scale": self.scale.tolist()}

    def cell(self, observation: NDArray[np.floating]) -> tuple[int, ...]:
        """Returns the index of an observation's row.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or lies outside.
        """
        if observation.dtype.kind not in "fiu":
            raise TypeError(f"observation must hold numbers, got {observation!r}")
        if observation.shape != self.low.shape:
            raise ValueError(f"observation must have shape {self.low.shape}, got {observation.shape}")
        with np.errstate(over="ignore", invalid="ignore"):
            observation = observation.astype(self.low.dtype)
            rounded = np.round((observation - self.low) * self.scale, 0)
        inside = (rounded >= 0) & (rounded < self.shape[:-1])
        if not inside.all():
            axis = int(np.argmin(inside))
            raise ValueError(f"observation[{axis}] is {observation[axis]}, outside the observation space")
        return tuple(int(index) for index in rounded)


Bounds = tuple[NDArray[np.floating], NDArray[np.floating]]


def box(env: gym.Env) -> tuple[Bounds, spaces.Discrete]:
    """Returns the bounds of the observations and the actions of an environment that tables can be learned for.

    Raises:
        ValueError: if a space does not fit; it says which, and what fits.
    """
    actions, observations = env.action_space, env.observation_space
    if not isinstance(actions, spaces.Discrete):
        raise ValueError(f"the action space must be Discrete, got {actions}")
    if not isinstance(observations, spaces.Box) or len(observations.shape) != 1 or observations.dtype not in FLOATS:
        raise ValueError(f"the observation space must be a Box of one float axis, got {observations}")
    return cast(Bounds, (observations.low, observations.high)), actions


def grid(env: gym.Env, scale: tuple[float, ...]) -> Grid:
    """Returns the grid over an environment's spaces.

    Raises:
        ValueError: if a space does not fit, or the table would be too large; it says which, and what fits.
    """
    (low, high), actions = box(env)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise ValueError(f"the observation space must have finite bounds, got {env.observation_space}")
    if not (low <= high).all():
        raise ValueError(f"the observation space must have low <= high, got {env.observation_space}")
    if len(scale) != len(low):
        raise ValueError(
            f"scale must hold {len(low)} numbers for this observation space, the cells per unit of each component, "
            f"got {scale!r}"
        )
    table = Grid(low, high, np.array(scale, dtype=np.float64), int(actions.n), int(actions.start))
    with np.errstate(over="ignore"):
        cells = (high - low).astype(np.float64) * table.scale
        count = float(np.prod(cells + 1)) * table.actions
    if not count < LARGEST_TABLE:
        raise ValueError(f"scale must give a table of fewer than 2**32 values, got {scale!r}, which needs {count:.3g}")
    try:
        np.empty(table.shape)
    except MemoryError:
        raise ValueError(
            f"scale must give a table that fits into memory, got {scale!r}, which needs {count:.3g} values"
        ) from None
    return table
