"""Discretizers in plain NumPy: from an observation to the active rows of the table."""

import math
from collections.abc import Iterable
from typing import Any, Protocol

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils.checks import required
from qtab.config import Config

_MASK = 2**64 - 1


def hashed_row(numbers: Iterable[int], rows: int) -> int:
    """Returns the row, from 0 to ``rows`` - 1, of a tile: its tiling and its coordinates.

    Starting from 0, each number is added to the hash, which SplitMix64 then mixes (G. Steele, D. Lea and C. Flood,
    "Fast splittable pseudorandom number generators", 2014, with the constants of Vigna's version). The row is the upper
    half of the hash, as a fraction of the table.
    """
    word = 0
    for number in numbers:
        word = (word + number + 0x9E37_79B9_7F4A_7C15) & _MASK
        word = ((word ^ (word >> 30)) * 0xBF58_476D_1CE4_E5B9) & _MASK
        word = ((word ^ (word >> 27)) * 0x94D0_49BB_1331_11EB) & _MASK
        word ^= word >> 31
    return (word >> 32) * rows >> 32


class Discretizer(Protocol):
    """Maps observations to rows of the table."""

    shape: tuple[int, ...]
    """The shape of the table, without its actions."""
    n_active: int
    """The number of active rows for an observation."""

    def rows(self, observation: ArrayLike) -> list[int]:
        """Returns the active rows of an observation."""


class Rounding:
    """The article's grid: the nearest cell."""

    n_active = 1

    def __init__(self, space: gym.spaces.Box, config: Config) -> None:
        self.low, self.scale = space.low, np.array(config.scale)
        cells = np.round((space.high - space.low) * self.scale, 0).astype(int) + 1
        self.shape = tuple(int(count) for count in cells)

    def rows(self, observation: ArrayLike) -> list[int]:
        """Returns one row; the cells are numbered in C order."""
        # Computed in the dtype of the space, whatever the dtype of the observation.
        cell = np.round((np.asarray(observation, dtype=self.low.dtype) - self.low) * self.scale, 0).astype(int)
        return [int(np.ravel_multi_index(tuple(cell), self.shape))]


class Bins:
    """A grid of bins: of equal width, or between the user's own edges."""

    n_active = 1

    def __init__(self, space: gym.spaces.Box, config: Config) -> None:
        self.dtype: Any = space.dtype
        if config.edges is not None:
            self.edges = [np.array(edges) for edges in config.edges]
        else:
            low, high = np.array(config.low, dtype=self.dtype), np.array(config.high, dtype=self.dtype)
            self.edges = [np.linspace(*ends) for ends in zip(low, high, np.array(config.bins) + 1, strict=True)]
            # Values beyond the limits belong to the outermost bins.
            self.edges = [edges[1:-1] for edges in self.edges]
        self.shape: tuple[int, ...] = tuple(len(edges) + 1 for edges in self.edges)

    def rows(self, observation: ArrayLike) -> list[int]:
        """Returns one row; the bins are numbered in C order."""
        numbers = np.asarray(observation, dtype=self.dtype)
        bins = [np.digitize(number, edges) for number, edges in zip(numbers, self.edges, strict=True)]
        return [int(np.ravel_multi_index(tuple(bins), self.shape))]


class TileCoding:
    """Tilings shifted by 1, 3, 5, … parts of a tile along the first, second, third … component (section 9.5.4).

    The tiles' rows are numbered in C order, or hashed into fewer rows.
    """

    def __init__(self, space: gym.spaces.Box, config: Config) -> None:
        tiles = required("tiles", config.tiles)
        self.dtype = space.dtype
        self.low, self.high = np.array(config.low), np.array(config.high)
        self.tiles, self.n_active = np.array(tiles), required("tilings", config.tilings)
        self.tiling_shape = tuple(count + 1 for count in tiles)
        self.hashed_rows = config.hashed_rows
        self.shape: tuple[int, ...] = (self.hashed_rows or self.n_active * math.prod(self.tiling_shape),)

    def rows(self, observation: ArrayLike) -> list[int]:
        """Returns one row of each tiling."""
        numbers = np.asarray(observation, dtype=self.dtype).astype(np.float64)
        clipped = np.clip(numbers, self.low, self.high)
        parts = np.floor((clipped - self.low) * (self.tiles / (self.high - self.low)) * self.n_active).astype(int)
        odd = 2 * np.arange(len(parts)) + 1
        shifts = [tiling * odd % self.n_active for tiling in range(self.n_active)]
        return [self.row(tiling, (parts + shift) // self.n_active) for tiling, shift in enumerate(shifts)]

    def row(self, tiling: int, tile: NDArray[np.int64]) -> int:
        """Returns the row of a tiling's tile."""
        if self.hashed_rows is not None:
            return hashed_row((tiling, *tile.tolist()), self.hashed_rows)
        return int(np.ravel_multi_index((tiling, *tile), (self.n_active, *self.tiling_shape)))


class Identity:
    """A row for each integer of a Discrete space."""

    n_active = 1

    def __init__(self, space: gym.spaces.Discrete) -> None:
        self.first = int(space.start)
        self.shape: tuple[int, ...] = (int(space.n),)

    def rows(self, observation: Any) -> list[int]:
        """Returns one row."""
        return [int(observation) - self.first]
