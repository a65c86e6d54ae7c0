"""What a callback receives while a sweep is in progress."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from qtab._utils.progress import ProgressBar


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
    """Moves the progress bar, and calls the callback with the progress since the reporter was created."""

    def __init__(self, total: int, finished: Callable[[], int], callback: Callback | None, bar: ProgressBar) -> None:
        self._total, self._finished, self._callback, self._bar = total, finished, callback, bar
        self._started = time.perf_counter()
        self._already_finished = finished()
        if self._already_finished:
            bar.move_to(self._already_finished)

    def __call__(self) -> None:
        """Reports the progress so far."""
        runs, seconds = self._finished(), time.perf_counter() - self._started
        self._bar.move_to(runs)
        if self._callback is not None:
            self._callback(SweepProgress(runs, self._total, runs - self._already_finished, seconds))
