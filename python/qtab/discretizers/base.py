"""What every discretizer has: from an observation to the rows of the table that it lights."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab import _spec
from qtab.discretizers.actions import FLOATS, Actions

LARGEST_TABLE = 2**32
"""Rows are numbered in 32 bits."""
Bounds = tuple[NDArray[np.floating], NDArray[np.floating]]


@dataclass(frozen=True)
class Features(ABC):
    """The observations of a space as rows of a table."""

    low: NDArray[Any]
    """(d,) the space's bounds, in its dtype."""
    high: NDArray[Any]
    """(d,)"""
    choices: Actions
    """What the columns of the table stand for."""

    @property
    def actions(self) -> int:
        """How many columns the table has."""
        return self.choices.count

    @property
    def first_action(self) -> int:
        """The environment's own number of the first of them, where its space is Discrete."""
        return self.choices.first

    @property
    @abstractmethod
    def shape(self) -> tuple[int, ...]:
        """The shape of the Q table: cells along each axis where there are any, else rows; then the actions."""

    @property
    def rows(self) -> int:
        """How many rows the table has."""
        return int(np.prod(self.shape[:-1]))

    @abstractmethod
    def lit(self, observation: NDArray[Any]) -> list[int]:
        """Returns the rows of an observation.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or no row.
        """

    @abstractmethod
    def spec(self) -> _spec.DiscretizerSpec:
        """Returns it as the extension module takes it."""

    def float_type(self) -> _spec.FloatType:
        """Returns the dtype of the observations of a Box."""
        return "float32" if self.low.dtype == np.float32 else "float64"

    def numbers(self, observation: NDArray[Any]) -> NDArray[np.floating]:
        """Returns an observation of a Box in the space's dtype.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or is NaN somewhere.
        """
        if observation.dtype.kind not in "fiu":
            raise TypeError(f"observation must hold numbers, got {observation!r}")
        if observation.shape != self.low.shape:
            raise ValueError(f"observation must have shape {self.low.shape}, got {observation.shape}")
        with np.errstate(over="ignore"):
            numbers = observation.astype(self.low.dtype)
        if np.isnan(numbers).any():
            raise ValueError(f"observation[{int(np.argmax(np.isnan(numbers)))}] is nan, outside the observation space")
        return numbers


def box(env: gym.Env) -> Bounds:
    """Returns the bounds of the observations of an environment whose space is a Box.

    Raises:
        ValueError: if it is another; it says which.
    """
    space = env.observation_space
    if not isinstance(space, spaces.Box) or len(space.shape) != 1 or space.dtype not in FLOATS:
        hint = (
            "; discretizer must be left out for it" if isinstance(space, spaces.Discrete | spaces.MultiDiscrete) else ""
        )
        raise ValueError(f"the observation space must be a Box of one float axis, got {space}{hint}")
    return cast(Bounds, (space.low, space.high))


def limits(
    env: gym.Env, low: Sequence[float] | None, high: Sequence[float] | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns what tilings or bins span: the limits given for all components, or else the space's own.

    Raises:
        ValueError: if there are none, they are not one for each component, or they do not rise.
    """
    edges = []
    for name, given, bound in zip(("low", "high"), (low, high), box(env), strict=True):
        edge = bound.astype(np.float64) if given is None else np.array(given)
        if edge.shape != bound.shape:
            raise ValueError(f"{name} must hold {len(bound)} numbers for this observation space, got {given!r}")
        if not np.isfinite(edge).all():
            raise ValueError(
                f"{name} must be given, a number for each component, where the observation space has no finite bounds: "
                f"{env.observation_space}"
            )
        edges.append(edge)
    if not (edges[0] < edges[1]).all():
        raise ValueError(f"low must lie below high, got {edges[0].tolist()} and {edges[1].tolist()}")
    return edges[0], edges[1]


def counts(name: str, given: tuple[int, ...], env: gym.Env) -> tuple[int, ...]:
    """Returns a count for each component, where there may be one for all.

    Raises:
        ValueError: if there are too few or too many.
    """
    (dimensions,) = cast(tuple[int], env.observation_space.shape)
    every = given * dimensions if len(given) == 1 else given
    if len(every) != dimensions:
        raise ValueError(f"{name} must hold {dimensions} numbers for this observation space, or one, got {given!r}")
    return every


def check_size(name: str, given: Any, values: float, instead: str = "") -> None:
    """Refuses a table of so many values that is too large, before it is made; ``instead`` says what else would do.

    Raises:
        ValueError: says what made it so large, and how large it would be.
    """
    if not values < LARGEST_TABLE:
        raise ValueError(
            f"{name} must give a table of fewer than 2**32 values{instead}, got {given!r}, which needs {values:.3g}"
        )
    try:
        np.empty(int(values))
    except MemoryError:
        raise ValueError(
            f"{name} must give a table that fits into memory{instead}, got {given!r}, which needs {values:.3g} values"
        ) from None
