"""What a callback sees of a run underway."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab import _core


@dataclass(frozen=True)
class Progress:
    """A run underway, as a callback sees it. The arrays of one call are the beginning of the next call's."""

    episodes: int
    """How many episodes are finished …"""
    total: int
    """… of how many."""
    returns: NDArray[np.float64]
    """(episodes,): the return of each finished episode."""
    lengths: NDArray[np.int64]
    """(episodes,): the steps of each finished episode."""


Callback = Callable[[Progress], bool | None]


class Finished:
    """The episodes that a trainer has finished. A look takes over what is new; what it saw before it does not copy."""

    def __init__(self, trainer: _core.Trainer, total: int) -> None:
        self._trainer, self._total = trainer, total
        self._episodes = 0
        self._returns, self._lengths = np.empty(0, np.float64), np.empty(0, np.int64)

    def look(self) -> Progress:
        """Returns the progress so far."""
        returns, lengths, _ = self._trainer.episodes(since=self._episodes)
        before, self._episodes = self._episodes, self._episodes + len(returns)
        if self._episodes > len(self._returns):
            # Twice as much room each time: over a run every episode is copied about once more.
            room = min(max(self._episodes, 2 * len(self._returns)), self._total)
            self._returns = _roomier(self._returns, before, room)
            self._lengths = _roomier(self._lengths, before, room)
        now = slice(before, self._episodes)
        self._returns[now], self._lengths[now] = returns, lengths
        return Progress(self._episodes, self._total, self._returns[: self._episodes], self._lengths[: self._episodes])


def _roomier(column: NDArray[Any], used: int, room: int) -> NDArray[Any]:
    roomier = np.empty(room, column.dtype)
    roomier[:used] = column[:used]
    return roomier
