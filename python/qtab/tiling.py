"""Tile coding over an environment's observations (Sutton & Barto, 2nd ed., section 9.5.4)."""

import math
from dataclasses import dataclass

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab import plan
from qtab.config import Config
from qtab.hashing import hashed_row
from qtab.spaces import LARGEST_TABLE, box


@dataclass(frozen=True)
class Tiling:
    """So many tilings of a box, each shifted by its own part of a tile, and the actions."""

    low: NDArray[np.floating]
    """(d,) the space's bounds in its dtype."""
    high: NDArray[np.floating]
    """(d,)"""
    edges: tuple[NDArray[np.float64], NDArray[np.float64]]
    """Two of (d,): what the tilings span. Observations are clipped to it."""
    tiles: tuple[int, ...]
    """Along each component."""
    tilings: int
    hashed_rows: int | None
    """How many rows the tilings share; None gives each tile its own."""
    actions: int
    first_action: int

    @property
    def rows(self) -> int:
        """How many rows the table has: the offsets add one tile along each component."""
        return self.hashed_rows or self.tilings * math.prod(count + 1 for count in self.tiles)

    @property
    def shape(self) -> tuple[int, int]:
        """The shape of the table: rows, actions."""
        return self.rows, self.actions

    def lit(self, observation: NDArray[np.floating]) -> list[int]:
        """Returns the rows of an observation, one of each tiling; a hashed one may come twice.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or is NaN.
        """
        if observation.dtype.kind not in "fiu":
            raise TypeError(f"observation must hold numbers, got {observation!r}")
        if observation.shape != self.low.shape:
            raise ValueError(f"observation must have shape {self.low.shape}, got {observation.shape}")
        with np.errstate(over="ignore"):
            numbers = observation.astype(self.low.dtype).astype(np.float64)
        if np.isnan(numbers).any():
            raise ValueError(f"observation[{int(np.argmax(np.isnan(numbers)))}] is nan, outside the observation space")
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

    def plan(self) -> plan.Tiles:
        """Returns it as the extension module takes it."""
        low, high = self.edges
        return {
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


def tiling(env: gym.Env, config: Config) -> Tiling:
    """Returns the tilings over an environment's observations; ``config`` has its options' defaults filled in.

    Raises:
        ValueError: if a space or an option does not fit, or the table would be too large; it says which.
    """
    bounds, actions = box(env)
    dimensions = len(bounds[0])
    edges = []
    for name, given, bound in (("low", config.low, bounds[0]), ("high", config.high, bounds[1])):
        edge = bound.astype(np.float64) if given is None else np.array(given)
        if edge.shape != bound.shape:
            raise ValueError(f"{name} must hold {dimensions} numbers for this observation space, got {given!r}")
        if not np.isfinite(edge).all():
            raise ValueError(
                f"{name} must be given where the observation space has no finite bounds: {env.observation_space}"
            )
        edges.append(edge)
    low, high = edges
    if not (low < high).all():
        raise ValueError(f"low must lie below high, got {low.tolist()} and {high.tolist()}")
    assert config.tiles is not None  # noqa: S101 - filled in
    assert config.tilings is not None  # noqa: S101
    tiles = config.tiles * dimensions if len(config.tiles) == 1 else config.tiles
    if len(tiles) != dimensions:
        raise ValueError(f"tiles must hold {dimensions} numbers for this observation space, or one, got {tiles!r}")
    found = Tiling(*bounds, (low, high), tiles, config.tilings, config.hashed_rows, int(actions.n), int(actions.start))
    # In floats: an integer may have more digits than a message has room for.
    size = float(config.hashed_rows or config.tilings * np.prod([count + 1.0 for count in tiles])) * found.actions
    name, asked = ("tiles", tiles) if config.hashed_rows is None else ("hashed_rows", config.hashed_rows)
    instead = ", or hashed_rows= of your choice" if config.hashed_rows is None else ""
    if not size < LARGEST_TABLE:
        raise ValueError(
            f"{name} must give a table of fewer than 2**32 values{instead}, got {asked!r}, which needs {size:.3g}"
        )
    try:
        np.empty(int(size))
    except MemoryError:
        raise ValueError(
            f"{name} must give a table that fits into memory{instead}, got {asked!r}, which needs {size:.3g} values"
        ) from None
    return found
