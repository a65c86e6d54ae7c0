"""Discretization of observations of any space, in plain NumPy."""

import math
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.reference.parts.discretizers import Bins, Discretizer, Identity, Rounding, TileCoding
from qtab.reference.parts.weighted import WEIGHTED, WeightedFeatures

Path = tuple[Any, ...]
SMALL = 1024
"""The largest number of values of an integer that indexes the table; others are discretized."""


def discretizer(env: gym.Env, config: Config) -> Discretizer:
    """Returns the discretizer of a complete config.

    Raises:
        TypeError: for an observation space that does not consist of numbers.
    """
    space: Any = env.observation_space
    cells: Any = Function(config) if callable(config.discretizer) else None
    if cells is None:
        if not isinstance(config.discretizer, dict) and config.max_rows is None:
            if isinstance(space, gym.spaces.Box) and space.dtype in (np.float32, np.float64) and len(space.shape) == 1:
                return of_box(space, config)
            if isinstance(space, gym.spaces.Discrete):
                return Identity(space)
        cells = Components(space, config)
    return cells if config.max_rows is None else AssignedRows(cells, config.max_rows)


def of_box(box: gym.spaces.Box, config: Config) -> Rounding | Bins | TileCoding | WeightedFeatures:
    """Returns the discretizer of a Box with one axis of floats."""
    chosen = str(config.discretizer)
    if chosen in WEIGHTED:
        return WEIGHTED[chosen](box, config)
    if chosen == "tiles":
        return TileCoding(box, config)
    return Rounding(box, config) if chosen == "round" else Bins(box, config)


class Components:
    """Each component of an observation is an index or is discretized, in Gymnasium's order, arrays in C order."""

    def __init__(self, space: gym.Space[Any], config: Config) -> None:
        self.leaves = dict(leaves(space))
        self.groups = [
            (paths, of_box(joined(self.leaves, paths), chosen)) for paths, chosen in grouped(self.leaves, config)
        ]
        self.grouped = {path for paths, _ in self.groups for path in paths}
        self.tiles = next((group for _, group in self.groups if isinstance(group, TileCoding)), None)
        self.n_active = 1 if self.tiles is None else self.tiles.n_active
        indices = {path: integers(leaf) for path, leaf in self.leaves.items() if path not in self.grouped}
        counts = {path: [count for _, count in found] for path, found in indices.items()}
        for paths, group in self.groups:
            if group is not self.tiles:
                counts |= self.by_part(paths, group.shape)
        self.cell_shape = self.in_order(counts)
        self.first = {path: np.array([first for first, _ in found], np.int64) for path, found in indices.items()}
        rows = 1 if self.tiles is None else math.prod(self.tiles.shape)
        self.shape: tuple[int, ...] = self.cell_shape if self.tiles is None else (math.prod(self.cell_shape) * rows,)

    def cells(self, observation: Any) -> tuple[int, ...]:
        """Returns the index of each component that is not tiled."""
        found: dict[Path, list[int]] = {}
        for path, first in self.first.items():
            found[path] = (np.ravel(part(observation, path)).astype(np.int64) - first).tolist()
        for paths, group in self.groups:
            if group is not self.tiles:
                (row,) = group.rows(self.numbers(observation, paths))
                found |= self.by_part(paths, map(int, np.unravel_index(row, group.shape)))
        return self.in_order(found)

    def by_part(self, paths: list[Path], numbers: Iterable[int]) -> dict[Path, list[int]]:
        """Returns the numbers of some parts, given one after the other, for each part."""
        left = iter(numbers)
        return {path: list(islice(left, size(self.leaves[path]))) for path in paths}

    def in_order(self, numbers: dict[Path, list[int]]) -> tuple[int, ...]:
        """Returns the numbers of the parts in the order of the space; a tiled part has none."""
        return tuple(number for path in self.leaves for number in numbers.get(path, ()))

    def numbers(self, observation: Any, paths: list[Path]) -> Any:
        """Returns the numbers of some parts of an observation, one after the other."""
        return np.concatenate([np.ravel(part(observation, path)) for path in paths])

    def rows(self, observation: Any) -> list[int]:
        """Returns one row, or with tile coding one of each tiling, among those for the other components."""
        cell = self.cells(observation)
        row = int(np.ravel_multi_index(cell, self.cell_shape)) if cell else 0
        if self.tiles is None:
            return [row]
        paths = next(paths for paths, group in self.groups if group is self.tiles)
        return [row * math.prod(self.tiles.shape) + tile for tile in self.tiles.rows(self.numbers(observation, paths))]


class Function:
    """The user's function, which returns indices within the shape or the number of a row."""

    n_active = 1

    def __init__(self, config: Config) -> None:
        self.function: Any = config.discretizer
        self.shape: tuple[int, ...] = config.shape or ()

    def cells(self, observation: Any) -> tuple[int, ...]:
        """Returns the indices."""
        returned = np.asarray(self.function(observation))
        if returned.ndim == 0 and len(self.shape) > 1:
            return tuple(int(index) for index in np.unravel_index(int(returned), self.shape))
        return tuple(np.atleast_1d(returned).tolist())

    def rows(self, observation: Any) -> list[int]:
        """Returns one row; the cells are numbered in C order."""
        return [int(np.ravel_multi_index(self.cells(observation), self.shape))]


class AssignedRows:
    """Rows in the order in which their cells are first seen, and one more."""

    n_active = 1

    def __init__(self, cells: Components | Function, max_rows: int) -> None:
        self.inner, self.seen = cells, dict[tuple[int, ...], int]()
        self.shape: tuple[int, ...] = (max_rows + 1,)

    def rows(self, observation: Any) -> list[int]:
        """Returns one row."""
        return [self.seen.setdefault(self.inner.cells(observation), len(self.seen))]


def leaves(space: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Yields the innermost spaces, each with its path.

    Raises:
        TypeError: for one that does not consist of numbers.
    """
    if isinstance(space, gym.spaces.Dict | gym.spaces.Tuple):
        parts: Any = space.spaces.items() if isinstance(space, gym.spaces.Dict) else enumerate(space.spaces)
        for key, inner in parts:
            yield from leaves(inner, (*path, key))
    elif isinstance(space, gym.spaces.Box | gym.spaces.Discrete | gym.spaces.MultiDiscrete | gym.spaces.MultiBinary):
        yield path, space
    else:
        raise TypeError(f"the observation space must consist of numbers, got {space}")


def part(observation: Any, path: Path) -> Any:
    """Returns a part of an observation."""
    for key in path:
        observation = observation[key]
    return observation


def size(leaf: Any) -> int:
    """Returns the number of components of a space."""
    return math.prod(leaf.shape)


def integers(leaf: Any) -> list[tuple[int, int]]:
    """Returns the first integer of each component and the number of integers; 0 stands for a missing bound."""
    if isinstance(leaf, gym.spaces.Discrete):
        return [(int(leaf.start), int(leaf.n))]
    if isinstance(leaf, gym.spaces.MultiDiscrete):
        return list(zip(np.ravel(leaf.start).tolist(), np.ravel(leaf.nvec).tolist(), strict=True))
    if isinstance(leaf, gym.spaces.MultiBinary):
        return [(0, 2)] * size(leaf)
    below, above = (np.ravel(bounded).tolist() for bounded in (leaf.bounded_below, leaf.bounded_above))
    ends = zip(np.ravel(leaf.low).tolist(), np.ravel(leaf.high).tolist(), below, above, strict=True)
    return [
        (int(low) if is_low else 0, int(high) - int(low) + 1 if is_high else 0) for low, high, is_low, is_high in ends
    ]


def is_integer_box(leaf: Any) -> bool:
    """Returns whether a space is a Box of integers, for which the user may choose a discretizer."""
    return isinstance(leaf, gym.spaces.Box) and np.issubdtype(leaf.dtype, np.integer)


def is_float_box(leaf: Any) -> bool:
    """Returns whether a space is a Box of floats."""
    return isinstance(leaf, gym.spaces.Box) and np.issubdtype(leaf.dtype, np.floating)


def is_divided(leaf: Any, config: Config) -> bool:
    """Returns whether a space is discretized: floats, and integers of many values in a table with all rows."""
    if not is_integer_box(leaf):
        return is_float_box(leaf)
    few = leaf.is_bounded() and max((count for _, count in integers(leaf)), default=0) <= SMALL
    return config.max_rows is None and not few


def grouped(parts: dict[Path, Any], config: Config) -> list[tuple[list[Path], Config]]:
    """Returns the parts that are discretized together, and the config with the options for them."""
    if isinstance(config.discretizer, dict):
        groups = []
        for key, options in config.discretizer.items():
            if options["discretizer"] != "identity":
                of_key = {path: leaf for path, leaf in parts.items() if str(path[0]) == key}
                boxes = [path for path, leaf in of_key.items() if is_integer_box(leaf) or is_float_box(leaf)]
                groups.append((boxes, replace_checked(config, **options)))
        return groups
    if config.discretizer == "identity":
        return []
    divided = [path for path, leaf in parts.items() if is_divided(leaf, config)]
    return [(divided or [path for path, leaf in parts.items() if is_integer_box(leaf)], config)]


def joined(parts: dict[Path, Any], paths: list[Path]) -> gym.spaces.Box:
    """Returns one Box of the components of several, in float64 unless float32 holds all of them."""
    boxes = [leaf for path, leaf in parts.items() if path in paths]
    dtype: Any = np.float32 if all(box.dtype in (np.float16, np.float32) for box in boxes) else np.float64
    low = np.concatenate([np.where(box.bounded_below, box.low.astype(dtype), -np.inf).ravel() for box in boxes])
    high = np.concatenate([np.where(box.bounded_above, box.high.astype(dtype), np.inf).ravel() for box in boxes])
    return gym.spaces.Box(low.astype(dtype), high.astype(dtype), dtype=dtype)
