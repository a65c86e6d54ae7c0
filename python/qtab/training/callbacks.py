"""What a callback receives while a run is in progress."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._utils.fields import with_fields


@with_fields
@dataclass(frozen=True)
class Progress:
    """The progress of a run, as a callback receives it. Later calls receive longer arrays with the same beginning."""

    episodes: int
    """How many episodes are finished."""
    total: int
    """How many episodes the run has."""
    returns: NDArray[np.float64]
    """(episodes,): the return of each finished episode."""
    lengths: NDArray[np.int64]
    """(episodes,): the steps of each finished episode."""


Callback = Callable[[Progress], bool | None]


class EpisodeReader:
    """Reads the finished episodes of a trainer. Each call copies only the episodes since the last one."""

    def __init__(self, trainer: _core.Trainer, total: int) -> None:
        self._trainer, self._total = trainer, total
        self._episodes = 0
        self._returns, self._lengths = np.empty(0, np.float64), np.empty(0, np.int64)

    def read(self) -> Progress:
        """Returns the progress so far."""
        returns, lengths, _ = self._trainer.episodes(since=self._episodes)
        before, self._episodes = self._episodes, self._episodes + len(returns)
        if self._episodes > len(self._returns):
            # Doubled each time, so that over a run every episode is copied about once more.
            capacity = min(max(self._episodes, 2 * len(self._returns)), self._total)
            self._returns = _enlarge(self._returns, before, capacity)
            self._lengths = _enlarge(self._lengths, before, capacity)
        now = slice(before, self._episodes)
        self._returns[now], self._lengths[now] = returns, lengths
        return Progress(self._episodes, self._total, self._returns[: self._episodes], self._lengths[: self._episodes])


def _enlarge(column: NDArray[Any], used: int, capacity: int) -> NDArray[Any]:
    enlarged = np.empty(capacity, column.dtype)
    enlarged[:used] = column[:used]
    return enlarged
