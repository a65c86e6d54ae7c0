"""An experiment that trains its settings and makes a line of the figure from each."""

import time
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.progress import ProgressBar
from qtab.book import runner
from qtab.book.drawing import draw_lines
from qtab.book.experiment import Experiment
from qtab.book.line import Line, joined, line_from_samples
from qtab.book.result import Result
from qtab.book.runner import EpisodeLog, FloatArray
from qtab.book.setting import Setting

MAX_EPISODE_STEPS = 5_000
"""The time limit of an experiment that does not set another one."""
BATCH_RUNS = 5_000
"""Runs are trained and measured in batches of this size, which bounds the memory and moves the progress bar."""


@dataclass(frozen=True, kw_only=True, repr=False)
class TrainingExperiment(Experiment):
    """An experiment that trains settings with many seeds."""

    counts_failures = True

    settings: Sequence[Setting]
    max_episode_steps: int = MAX_EPISODE_STEPS
    """Episodes are truncated after this many steps. The book has no time limit."""

    def conditions(self, counts: Collection[int], runs: int, seed: int) -> str:
        """Returns how a result was made, in words; see ``Description.conditions``."""
        limit = f"episodes are truncated at {self.max_episode_steps:,} steps"
        return f"{super().conditions(counts, runs, seed)}; {limit}"

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        return tuple(dict.fromkeys(setting.line for setting in self.settings))

    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Trains every setting with every seed; see :func:`qtab.book.run`."""
        runs, seed, threads = self.check_arguments(runs, seed, threads)
        started = time.perf_counter()
        counts = [min(runs, setting.max_runs or runs) for setting in self.settings]
        parts: dict[str, list[Line]] = {}
        with ProgressBar(sum(counts), "run", progress, self.name) as bar:
            done = 0
            for setting, count in zip(self.settings, counts, strict=True):
                samples = _Samples(setting)
                for first in range(0, count, BATCH_RUNS):
                    seeds = range(seed + first, seed + min(first + BATCH_RUNS, count))
                    samples.add(runner.train_runs(setting.env, self.config(setting), seeds, threads))
                    done += len(seeds)
                    bar.move_to(done)
                parts.setdefault(setting.line, []).append(samples.line())
        lines = tuple(map(joined, parts.values()))
        return Result(self, lines, runs, seed, time.perf_counter() - started, draw_lines)

    def config(self, setting: Setting) -> dict[str, Any]:
        """Returns the keyword arguments of :func:`qtab.train` for a setting, without the seed."""
        return {"max_episode_steps": self.max_episode_steps, **setting.config}


class _Samples:
    """The measurements of a setting, collected over batches of runs."""

    def __init__(self, setting: Setting) -> None:
        self._setting = setting
        self._batches: list[FloatArray] = []
        self._truncated: NDArray[np.int64] = np.zeros(1, np.int64)
        self._diverged = 0

    def add(self, log: EpisodeLog) -> None:
        self._batches.append(self._setting.measure(log))
        # A point of a learning curve is made from one episode of each run, any other point from all episodes.
        is_curve = self._setting.x is None
        self._truncated = self._truncated + (log.truncated.sum(axis=0) if is_curve else log.truncated.sum())
        self._diverged += int(log.diverged.sum())

    def line(self) -> Line:
        return line_of(self._setting, np.concatenate(self._batches), self._truncated, self._diverged)


def line_of(setting: Setting, samples: FloatArray, truncated: "NDArray[np.int64] | int", diverged: int) -> Line:
    """Returns the line through the points of one setting; see :func:`qtab.book.line.line_from_samples`."""
    x = np.arange(1.0, samples.shape[1] + 1) if setting.x is None else setting.x
    style = {"drawn": setting.drawn, "method": setting.method, "dashed": setting.dashed}
    return line_from_samples(setting.line, x, samples, truncated, diverged, **style)
