"""A row of the table for each observation of a discrete space."""

from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab import _spec
from qtab.discretizers.actions import Actions
from qtab.discretizers.base import Features, check_size


@dataclass(frozen=True)
class Cells(Features):
    """Observations that are whole numbers from ``low`` to ``high``, their rows counted in C order.

    The bounds are int64, of shape () for a Discrete space, else (d,).
    """

    @property
    def counts(self) -> tuple[int, ...]:
        """How many numbers each component takes."""
        return tuple(np.ravel(self.high - self.low + 1).tolist())

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of each component, then the actions: the shape of the Q table."""
        return (*self.counts, self.actions)

    def lit(self, observation: NDArray[Any]) -> list[int]:
        """Returns the rows of an observation: one.

        Raises:
            TypeError: if it holds no integers.
            ValueError: if it has another shape than the space, or lies outside.
        """
        if observation.dtype.kind not in "iub":
            raise TypeError(f"observation must hold integers, got {observation!r}")
        if observation.shape != self.low.shape:
            raise ValueError(f"observation must have shape {self.low.shape}, got {observation.shape}")
        numbers = [int(number) for number in np.ravel(observation)]
        row = 0
        for axis, (number, first, count) in enumerate(zip(numbers, np.ravel(self.low), self.counts, strict=True)):
            if not 0 <= number - int(first) < count:
                raise ValueError(f"observation[{axis}] is {number}, outside the observation space")
            row = row * count + number - int(first)
        return [row]

    def spec(self) -> _spec.IdentitySpec:
        """Returns it as the extension module takes it."""
        first = np.ravel(self.low).tolist()
        return {"type": "identity", "first": first, "counts": list(self.counts), "scalar": not self.low.shape}


def components(space: gym.Space[Any]) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """Returns the first and the last numbers of a discrete space; None for any other space."""
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


def cells(env: gym.Env, actions: Actions) -> Cells:
    """Returns the rows of an environment's observations.

    Raises:
        ValueError: if a space does not fit, or the table would be too large; it says which, and what fits.
    """
    found = components(env.observation_space)
    if found is None:
        raise ValueError(
            "the observation space must be Discrete, or a row of them, for discretizer 'identity', got "
            f"{env.observation_space}"
        )
    low, high = found
    values = float(np.prod((high - low + 1).astype(np.float64))) * actions.count
    check_size("the observation space", env.observation_space, values)
    return Cells(low, high, actions)
