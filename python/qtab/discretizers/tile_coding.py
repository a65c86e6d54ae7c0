"""Tile coding over an environment's observations (Sutton & Barto, 2nd ed., section 9.5.4)."""

import math
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab import _spec
from qtab.config import Config
from qtab.discretizers.actions import Actions
from qtab.discretizers.base import Features, box, check_size, counts, limits
from qtab.discretizers.hashing import hashed_row

MOST_PARTS = 2**32
"""Each tile has as many parts as there are tilings, and a place is counted in parts."""


@dataclass(frozen=True)
class Tiling(Features):
    """So many tilings of a box, each shifted by its own part of a tile."""

    edges: tuple[NDArray[np.float64], NDArray[np.float64]]
    """Two of (d,): what the tilings span. Observations are clipped to it."""
    tiles: tuple[int, ...]
    """Along each component."""
    tilings: int
    hashed_rows: int | None
    """How many rows the tilings share; None gives each tile its own."""

    def __post_init__(self) -> None:
        """Refuses what no tile can be found in.

        Raises:
            ValueError: where a tile is narrower than numbers are, or the parts of tiles outnumber 32 bits.
        """
        if max(self.tiles) * self.tilings >= MOST_PARTS:
            raise ValueError(
                f"tiles must come to fewer than 2**32 along a component, times {self.tilings} tilings, got {self.tiles}"
            )
        low, high = self.edges
        with np.errstate(over="ignore", divide="ignore"):
            tiles_a_unit = np.array(self.tiles) / (high - low)
        if not (np.isfinite(tiles_a_unit) & (tiles_a_unit > 0)).all():
            raise ValueError(
                f"high must lie neither so close above low nor so far, got {low.tolist()} and {high.tolist()}"
            )

    @property
    def rows(self) -> int:
        """How many rows the table has: the offsets add one tile along each component."""
        return self.hashed_rows or self.tilings * math.prod(count + 1 for count in self.tiles)

    @property
    def shape(self) -> tuple[int, int]:
        """The shape of the table: rows, actions."""
        return self.rows, self.actions

    def lit(self, observation: NDArray[Any]) -> list[int]:
        """Returns the rows of an observation, one of each tiling; a hashed one may come twice.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or is NaN.
        """
        numbers = self.numbers(observation).astype(np.float64)
        low, high = self.edges
        parts = np.floor((np.clip(numbers, low, high) - low) * (np.array(self.tiles) / (high - low)) * self.tilings)
        rows = []
        for tiling in range(self.tilings):
            tile = [
                (part + tiling * (2 * index + 1) % self.tilings) // self.tilings
                for index, part in enumerate(parts.astype(int).tolist())
            ]
            if self.hashed_rows is not None:
                rows.append(hashed_row((tiling, *tile), self.hashed_rows))
            else:
                rows.append(_dense_row(tiling, tile, self.tiles))
        return rows

    def spec(self) -> _spec.TilesSpec:
        """Returns it as the extension module takes it."""
        low, high = self.edges
        return {
            "type": "tiles",
            "dtype": self.float_type(),
            "low": low.tolist(),
            "high": high.tolist(),
            "tiles": list(self.tiles),
            "tilings": self.tilings,
            "hashed_rows": self.hashed_rows,
        }


def _dense_row(tiling: int, tile: list[int], tiles: tuple[int, ...]) -> int:
    row = tiling
    for coordinate, count in zip(tile, tiles, strict=True):
        row = row * (count + 1) + coordinate
    return row


def tiling(env: gym.Env, config: Config, actions: Actions) -> Tiling:
    """Returns the tilings over an environment's observations; ``config`` has its options' defaults filled in.

    Raises:
        ValueError: if a space or an option does not fit, or the table would be too large; it says which.
    """
    edges = limits(env, config.low, config.high)
    assert config.tiles is not None  # noqa: S101 - filled in
    assert config.tilings is not None  # noqa: S101
    tiles = counts("tiles", config.tiles, env)
    if config.hashed_rows is not None:
        check_size("hashed_rows", config.hashed_rows, float(config.hashed_rows) * actions.count)
    else:
        values = config.tilings * float(np.prod([count + 1.0 for count in tiles])) * actions.count
        check_size("tiles", tiles, values, ", or hashed_rows= of your choice")
    return Tiling(*box(env), actions, edges, tiles, config.tilings, config.hashed_rows)
