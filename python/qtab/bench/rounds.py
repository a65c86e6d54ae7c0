"""Timing in rounds: each subject once a round, so that a slow moment of the machine slows them all."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qtab._utils.progress import ProgressBar

Subject = Callable[[int], int]
"""Works through one round, whose number it is given, and returns the number of steps that it took."""

LEAST_ROUNDS = 3


@dataclass(frozen=True)
class Timings:
    """Nanoseconds a step of each subject, a value for each round."""

    nanoseconds: Mapping[str, NDArray[np.float64]]

    def median(self, subject: str) -> float:
        """Returns a subject's median nanoseconds a step."""
        return float(np.median(self.nanoseconds[subject]))

    def ratio(self, slow: str, fast: str) -> float:
        """Returns how many times faster ``fast`` is: the median of the ratios within each round."""
        return float(np.median(self.nanoseconds[slow] / self.nanoseconds[fast]))


def measure(
    subjects: Mapping[str, Subject], *, seconds: float, rounds: int | None = None, progress: bool | None = None
) -> Timings:
    """Times subjects in interleaved rounds, after one that warms them up and is not counted.

    Args:
        subjects: What to time, by name.
        seconds: About how long to go on for; at least three rounds are made.
        rounds: How many rounds to make instead.
        progress: Whether to show a bar; None shows one on a terminal.
    """
    _round(subjects, 0)
    count = rounds if rounds is not None else max(LEAST_ROUNDS, int(seconds / _seconds_of_a_round(subjects)))
    with ProgressBar(count, "round", progress) as shown:
        table = []
        for index in range(count):
            table.append(_round(subjects, index + 1))
            shown.move_to(index + 1)
    return Timings({name: np.array([row[name] for row in table]) for name in subjects})


def _seconds_of_a_round(subjects: Mapping[str, Subject]) -> float:
    began = time.perf_counter()
    _round(subjects, 0)
    return time.perf_counter() - began


def _round(subjects: Mapping[str, Subject], index: int) -> dict[str, float]:
    times = {}
    for name, subject in subjects.items():
        began = time.perf_counter_ns()
        steps = subject(index)
        times[name] = (time.perf_counter_ns() - began) / steps
    return times
