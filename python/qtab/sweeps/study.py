"""What a sweep will do, known whole before it starts: settings, seeds, pieces."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from qtab._utils.memory import BYTES_AN_EPISODE, check_memory
from qtab.config import known_fields
from qtab.sweeps import designs
from qtab.training.resolve import Resolved
from qtab.training.train_many import resolve_one, seed_numbers

PIECE_STEPS = 2**26
"""A piece is about so many steps, a second of Rust on one core …"""
PYTHON_PIECE_STEPS = 2**16
"""… or of a Python environment."""
LIKELY_STEPS = 1000
"""Episodes with a longer time limit than this are taken to end by themselves."""
PIECE_RUNS = 4096
"""A piece holds no more runs than this."""


@dataclass(frozen=True)
class Piece:
    """Runs that are done, and stored, together: from ``start`` up to ``stop``, counted through the whole sweep."""

    number: int
    start: int
    stop: int


@dataclass(frozen=True)
class Study:
    """Run ``i`` is of setting ``i // len(seeds)`` and seed ``i % len(seeds)``: every setting has the same seeds."""

    env: Any
    fixed: Mapping[str, Any]
    settings: Sequence[Mapping[str, Any]]
    seeds: tuple[int, ...]
    resolved: Sequence[Resolved]
    """What each setting comes to."""
    block: int
    """Learning curves are kept as the means of so many episodes."""

    @property
    def runs(self) -> int:
        """How many there are."""
        return len(self.settings) * len(self.seeds)

    @cached_property
    def pieces(self) -> list[Piece]:
        """The runs, cut by what they are and not by how long they take: the same at every call."""
        found: list[Piece] = []
        start, load = 0, 0.0
        for run in range(self.runs):
            if load >= 1 or run - start >= PIECE_RUNS:
                found.append(Piece(len(found), start, run))
                start, load = run, 0.0
            load += _load(self.resolved[run // len(self.seeds)])
        return [*found, Piece(len(found), start, self.runs)]

    def check_memory(self, limit: int) -> None:
        """Refuses a setting of which a single run needs more than the limit.

        Raises:
            MemoryError: says how much it needs.
        """
        for resolved in self.resolved:
            episodes = resolved.config.episodes
            # The trainer's own lists, and the arrays that they are copied to.
            needed = 2 * episodes * BYTES_AN_EPISODE + 8 * math.prod(resolved.grid.shape)
            check_memory(f"runs of {episodes} episodes", needed, limit)

    @cached_property
    def identity(self) -> str:
        """A text that is equal for equal sweeps alone."""
        configs = [
            {name: value for name, value in vars(resolved.config).items() if name != "seed"}
            for resolved in self.resolved
        ]
        settings = [dict(setting) for setting in self.settings]
        content: dict[str, Any] = {"configs": configs, "settings": settings, "seeds": self.seeds, "block": self.block}
        content |= {"pieces": len(self.pieces)}
        return json.dumps(content, sort_keys=True, default=_described)

    def share(self, piece: Piece) -> list[tuple[int, list[int]]]:
        """Returns the settings of a piece, and the seeds of each."""
        count = len(self.seeds)
        shares = []
        for setting in range(piece.start // count, (piece.stop - 1) // count + 1):
            first, last = max(piece.start - setting * count, 0), min(piece.stop - setting * count, count)
            shares.append((setting, list(self.seeds[first:last])))
        return shares


def study(env: Any, grid: Any, seeds: Any, block: int, fixed: Mapping[str, Any]) -> Study:
    """Checks what was asked for, every setting of it.

    Raises:
        gymnasium.error.Error: Gymnasium's own, for an id that it does not know.
        TypeError: for an argument of the wrong type, or an unknown one.
        ValueError: for an argument out of range.
    """
    numbers = seed_numbers(seeds)
    settings = _settings(grid)
    names = list(settings[0])
    known_fields({**fixed, **settings[0]})
    for setting in settings:
        if list(setting) != names:
            raise ValueError(f"grid must give every setting the same names, got {names} and {list(setting)}")
    for name in ("seed", "env"):
        if name in names or name in fixed:
            raise TypeError(f"{name} is no part of a grid: it is given by {name}{'s' * (name == 'seed')}=...")
    twice = set(names) & set(fixed)
    if twice:
        raise TypeError(f"{sorted(twice)[0]} is both in the grid and fixed")
    resolved = [resolve_one(env, {**fixed, **setting, "seed": max(numbers)}) for setting in settings]
    return Study(env, dict(fixed), settings, numbers, resolved, block)


def _settings(grid: Any) -> list[dict[str, Any]]:
    if isinstance(grid, Mapping):
        return designs.grid(grid)
    if isinstance(grid, (str, bytes)) or not isinstance(grid, Sequence):
        raise TypeError(f"grid must map names to lists of values, or be a list of settings, got {grid!r}")
    if not grid:
        raise ValueError("grid must hold at least one setting, got none")
    for setting in grid:
        if not isinstance(setting, Mapping):
            raise TypeError(f"grid must hold mappings of names to values, got {setting!r}")
    if len({json.dumps(dict(setting), sort_keys=True, default=_described) for setting in grid}) < len(grid):
        raise ValueError("grid must hold different settings, got one twice")
    return [dict(setting) for setting in grid]


def _load(resolved: Resolved) -> float:
    """The share of a piece that a run makes up."""
    config = resolved.config
    steps = config.episodes * min(config.max_episode_steps or LIKELY_STEPS, LIKELY_STEPS)
    return steps / (PYTHON_PIECE_STEPS if resolved.model is None else PIECE_STEPS)


def _described(value: Any) -> Any:
    """What JSON has no word for."""
    if isinstance(value, np.ndarray):
        return {"shape": value.shape, "sha256": hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return dict(value)
    return repr(value)


def plain(value: Any) -> Any:
    """Returns a setting's value as a table's cell: a number, a text, a boolean or None."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else repr(value)
    return json.dumps(value, default=_described)
