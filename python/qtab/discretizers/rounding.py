"""The article's grid over an environment's observations."""

from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab import _spec
from qtab.discretizers.actions import Actions
from qtab.discretizers.actions import actions as choices_of
from qtab.discretizers.base import Features, box, check_size


@dataclass(frozen=True)
class Grid(Features):
    """The article's discretizer over a Box: the nearest cell."""

    scale: NDArray[np.float64]
    """(d,) cells per unit."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Cells along each axis, then the actions: the shape of the Q table."""
        cells = np.round((self.high - self.low) * self.scale, 0).astype(int) + 1
        return (*(int(count) for count in cells), self.actions)

    def lit(self, observation: NDArray[Any]) -> list[int]:
        """Returns the rows of an observation: one.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or lies outside.
        """
        return [int(np.ravel_multi_index(self.cell(observation), self.shape[:-1]))]

    def spec(self) -> _spec.RoundSpec:
        """Returns it as the extension module takes it."""
        return {
            "type": "round",
            "dtype": self.float_type(),
            "low": self.low.astype(np.float64).tolist(),
            "high": self.high.astype(np.float64).tolist(),
            "scale": self.scale.tolist(),
        }

    def cell(self, observation: NDArray[Any]) -> tuple[int, ...]:
        """Returns the index of an observation's row.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or lies outside.
        """
        numbers = self.numbers(observation)
        with np.errstate(over="ignore", invalid="ignore"):
            rounded = np.round((numbers - self.low) * self.scale, 0)
        inside = (rounded >= 0) & (rounded < self.shape[:-1])
        if not inside.all():
            axis = int(np.argmin(inside))
            raise ValueError(f"observation[{axis}] is {numbers[axis]}, outside the observation space")
        return tuple(int(index) for index in rounded)


def grid(env: gym.Env, scale: tuple[float, ...], actions: Actions | None = None) -> Grid:
    """Returns the grid over an environment's spaces.

    Raises:
        ValueError: if a space does not fit, or the table would be too large; it says which, and what fits.
    """
    low, high = box(env)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise ValueError(
            f"the observation space must have finite bounds, got {env.observation_space}; "
            "discretizer 'bins' and 'tiles' take low= and high="
        )
    if not (low <= high).all():
        raise ValueError(f"the observation space must have low <= high, got {env.observation_space}")
    if len(scale) != len(low):
        raise ValueError(
            f"scale must hold {len(low)} numbers for this observation space, the cells per unit of each component, "
            f"got {scale!r}; or discretizer 'bins' or 'tiles' instead"
        )
    choices = choices_of(env.action_space, None) if actions is None else actions
    table = Grid(low, high, choices, np.array(scale, dtype=np.float64))
    with np.errstate(over="ignore"):
        cells = (high - low).astype(np.float64) * table.scale
        check_size("scale", scale, float(np.prod(cells + 1)) * choices.count)
    return table
