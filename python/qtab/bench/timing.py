"""Timing in interleaved rounds, so that a slow moment of the machine slows down all benchmarks alike."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qtab._utils.progress import ProgressBar

Benchmark = Callable[[int], int]
"""Runs one round, given its number, and returns the number of environment steps."""

MIN_ROUNDS = 3


@dataclass(frozen=True)
class Timings:
    """The times of all benchmarks."""

    nanoseconds: Mapping[str, NDArray[np.float64]]
    """For each benchmark (rounds,): nanoseconds per step."""

    def median(self, name: str) -> float:
        """Returns the median nanoseconds per step of a benchmark."""
        return float(np.median(self.nanoseconds[name]))

    def ratio(self, slow: str, fast: str) -> float:
        """Returns how many times as fast ``fast`` is as ``slow``: the median over the rounds of their ratios."""
        return float(np.median(self.nanoseconds[slow] / self.nanoseconds[fast]))


def measure(
    benchmarks: Mapping[str, Benchmark], *, seconds: float, rounds: int | None = None, progress: bool | None = None
) -> Timings:
    """Runs benchmarks in interleaved rounds, after a warm-up round that is not counted.

    Args:
        benchmarks: The benchmarks by name.
        seconds: The approximate duration; there are at least three rounds.
        rounds: The number of rounds; None derives it from ``seconds``.
        progress: Whether to show a progress bar; None shows one on a terminal.
    """
    _run_round(benchmarks, 0)
    count = rounds if rounds is not None else max(MIN_ROUNDS, int(seconds / _seconds_per_round(benchmarks)))
    with ProgressBar(count, "round", progress) as bar:
        results = []
        for index in range(count):
            results.append(_run_round(benchmarks, index + 1))
            bar.move_to(index + 1)
    return Timings({name: np.array([result[name] for result in results]) for name in benchmarks})


def _seconds_per_round(benchmarks: Mapping[str, Benchmark]) -> float:
    started = time.perf_counter()
    _run_round(benchmarks, 0)
    return time.perf_counter() - started


def _run_round(benchmarks: Mapping[str, Benchmark], index: int) -> dict[str, float]:
    """Returns the nanoseconds per step of each benchmark."""
    nanoseconds = {}
    for name, benchmark in benchmarks.items():
        started = time.perf_counter_ns()
        steps = benchmark(index)
        nanoseconds[name] = (time.perf_counter_ns() - started) / steps
    return nanoseconds
