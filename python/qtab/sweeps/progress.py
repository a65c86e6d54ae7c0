"""What a callback receives while a sweep is in progress."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class SweepProgress:
    """The progress of a sweep, as a callback receives it."""

    runs: int
    """The number of finished runs, including those found in the store."""
    total: int
    """The number of runs of the sweep."""
    new: int
    """The number of runs finished since this call began, by any process."""
    seconds: float
    """The wall-clock time since this call began."""


Callback = Callable[[SweepProgress], Any]


class ProgressReporter:
    """Calls the callback with the progress since the reporter was created."""

    def __init__(self, total: int, finished: Callable[[], int], callback: Callback | None) -> None:
        self._total, self._finished, self._callback = total, finished, callback
        self._started = time.perf_counter()
        self._already_finished = finished()

    def __call__(self) -> None:
        """Reports the progress so far."""
        if self._callback is not None:
            runs, seconds = self._finished(), time.perf_counter() - self._started
            self._callback(SweepProgress(runs, self._total, runs - self._already_finished, seconds))
