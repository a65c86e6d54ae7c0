"""The progress of many runs: the argument of callbacks of ``train_many``, and training in parts between calls."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._spec import Results
from qtab._utils import checks
from qtab._utils.progress import ProgressBar
from qtab.results.runs import Runs
from qtab.training.callbacks import BaseCallback, as_tuple
from qtab.training.setup.resolved_run import ResolvedRun

SECONDS_PER_PART = 1.0
"""The approximate time between two calls if ``callback_every`` is not set."""
LANES = 8
"""A thread trains up to this many runs at once, as in ``rust/core/src/simd/mod.rs``; a part that divides evenly leaves
none of them idle."""


@dataclass(frozen=True, eq=False)
class RunsProgress:
    """The progress of many runs, as a callback receives it."""

    runs: int
    """The number of finished runs."""
    total: int
    """The number of all runs."""
    seconds: float
    """The wall-clock time since the training began."""
    _seeds: Sequence[int] = field(repr=False)
    _results: Results = field(repr=False)
    _finished: NDArray[np.bool_] = field(repr=False)
    _make_runs: "MakeRuns" = field(repr=False)

    @property
    def seeds(self) -> tuple[int, ...]:
        """(runs,): the seeds of the finished runs, in the order of the call."""
        return tuple(seed for seed, done in zip(self._seeds, self._finished, strict=True) if done)

    @cached_property
    def returns(self) -> NDArray[np.float64]:
        """(runs, episodes): the returns of the finished runs, copied when first read."""
        return self._results["returns"][self._finished]

    @cached_property
    def lengths(self) -> NDArray[np.int64]:
        """(runs, episodes): the number of steps of each episode of the finished runs, copied when first read."""
        return self._results["lengths"][self._finished]

    @cached_property
    def finished(self) -> Runs:
        """The finished runs, copied when first read, to be plotted or saved."""
        return self._make_runs(self._finished)


MakeRuns: TypeAlias = Callable[[NDArray[np.bool_]], Runs]
"""Returns the runs that a mask selects."""
RunsCallback: TypeAlias = Callable[[RunsProgress], bool | None]


class RunsReporter:
    """Moves the progress bar and calls the callbacks of many runs.

    Raises:
        ModuleNotFoundError: if ``progress`` is True and tqdm is not installed.
        TypeError: for an argument of the wrong type.
        ValueError: if ``callback_every`` is less than one.
    """

    def __init__(
        self,
        callback: RunsCallback | Sequence[RunsCallback] | None,
        callback_every: int | None,
        progress: bool | None,
    ) -> None:
        self._callbacks = as_tuple(callback)
        for one in self._callbacks:
            if isinstance(one, BaseCallback):
                name = type(one).__name__
                raise TypeError(f"callback must take a RunsProgress; {name} works only with qtab.train, a single run")
        self.every = None if callback_every is None else checks.integer("callback_every", callback_every, least=1)
        self._progress = progress
        self._bar: ProgressBar | None = None
        self._began = time.perf_counter()
        self._called_at = 0
        self.stopped = False

    def start(self, seeds: Sequence[int], results: Results, make_runs: MakeRuns) -> ProgressBar:
        """Returns the progress bar of runs that begin now, as a context manager."""
        self._seeds, self._results, self._began = seeds, results, time.perf_counter()
        self._make_runs = make_runs
        self._bar = ProgressBar(len(seeds), "run", self._progress)
        return self._bar

    @property
    def is_used(self) -> bool:
        """Whether there is a progress bar or a callback."""
        return bool(self._callbacks) or (self._bar is not None and self._bar.is_shown)

    def report(self) -> bool:
        """Reports the finished runs; returns False if a callback stops the training."""
        finished = self._results["finished"].copy()
        count, total = int(finished.sum()), len(finished)
        if self._bar is not None:
            self._bar.move_to(count)
        if count - self._called_at < (self.every or 1) and count < total:
            return True
        self._called_at = count
        seconds = time.perf_counter() - self._began
        progress = RunsProgress(count, total, seconds, self._seeds, self._results, finished, self._make_runs)
        answers = [callback(progress) for callback in self._callbacks]
        self.stopped = not all(answer is None or bool(answer) for answer in answers)
        return not self.stopped


def train_in_parts(
    resolved: ResolvedRun,
    seeds: Sequence[int],
    results: Results,
    threads: int,
    memory: tuple[int, int],
    reporter: RunsReporter,
) -> list[tuple[int, Exception]]:
    """Trains a native environment with many seeds in parts, and reports after each part.

    Returns the index and the error of each failed run; no part is started after a failure.
    """
    spec, done, size = resolved.spec(), 0, min(reporter.every or threads, len(seeds))
    while done < len(seeds):
        part = slice(done, done + size)
        rows: Any = {name: array[part] for name, array in results.items()}  # type: ignore[index]
        began = time.perf_counter()
        failed = _core.train_many(spec, seeds[part], rows, threads, False, memory)
        if failed:
            return [(done + index, error) for index, error in failed]
        done += len(seeds[part])
        if not reporter.report():
            break
        if reporter.every is None:
            size = _next_size(size, time.perf_counter() - began, threads)
    return []


def _next_size(runs: int, seconds: float, threads: int) -> int:
    """Returns a number of runs that take about a second, a multiple of the runs that all threads train at once."""
    wanted = min(int(runs * SECONDS_PER_PART / max(seconds, 1e-9)), 8 * runs)
    for together in (threads * LANES, threads):
        if wanted >= together:
            return wanted // together * together
    return max(wanted, 1)
