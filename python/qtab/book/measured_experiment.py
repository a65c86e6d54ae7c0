"""Experiments that run their settings with many seeds, and measure the runs."""

from abc import abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from qtab._utils.progress import ProgressBar
from qtab.book import runner
from qtab.book.experiment import Experiment, Outcome
from qtab.book.line import Line, joined, line_from_samples
from qtab.book.runner import FloatArray
from qtab.book.setting import Setting


class Measured(NamedTuple):
    """The measurements of some runs of a setting."""

    samples: FloatArray
    """(runs, points): the measurements."""
    truncated: "NDArray[np.int64] | int" = 0
    """The number of truncated episodes, for all points or (points,) for each."""
    diverged: int = 0
    """The number of runs that diverged."""


@dataclass(frozen=True, kw_only=True, repr=False)
class MeasuredExperiment(Experiment):
    """An experiment that runs settings with many seeds, and makes lines of the figure from them."""

    BATCH_RUNS: ClassVar[int] = 5_000
    """Runs are executed and measured in batches of this size, which bounds the memory and advances the progress bar."""

    settings: Sequence[Any]
    """Each is a :class:`qtab.book.setting.LineSetting`, with the name of its ``line`` and its coordinates ``x``."""

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        names: list[str] = []
        for setting in self.settings:
            names += [f"{setting.line} {run + 1}" for run in range(self.runs)] if setting.each_run else [setting.line]
        return tuple(dict.fromkeys(names))

    @abstractmethod
    def _measure(self, setting: Any, seeds: range, threads: int) -> Mapping[str, Measured]:
        """Returns the measurements of a run with each seed, by the name of their line."""

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:
        """Runs every setting with every seed."""
        counts = [min(runs, setting.max_runs or runs) for setting in self.settings]
        parts: dict[str, list[tuple[Any, Measured]]] = {}
        with ProgressBar(sum(counts), "run", progress, self.name) as bar:
            done = 0
            for setting, count in zip(self.settings, counts, strict=True):
                batches: dict[str, list[Measured]] = {}
                # Runs that each give a line are long: the bar advances whenever every thread has finished one.
                size = threads if setting.each_run else self.BATCH_RUNS
                for first in range(0, count, size):
                    seeds = range(seed + first, seed + min(first + size, count))
                    for name, measured in self._measure(setting, seeds, threads).items():
                        batches.setdefault(name, []).append(measured)
                    done += len(seeds)
                    bar.move_to(done)
                for name, measured in _together(batches, setting.each_run).items():
                    parts.setdefault(name, []).append((setting, measured))
        names = [name for name in {**dict.fromkeys(self.line_names), **parts} if name in parts]
        return Outcome([self._line(name, parts[name]) for name in names])

    def _line(self, name: str, parts: Sequence[tuple[Any, Measured]]) -> Line:
        """Returns the line through the points of one or several settings."""
        return joined([line_of(setting, measured, name) for setting, measured in parts])


def line_of(setting: Any, measured: Measured, name: str | None = None) -> Line:
    """Returns the line through the points of one setting."""
    x = np.arange(1, measured.samples.shape[1] + 1) if setting.x is None else setting.x
    return line_from_samples(setting.line if name is None else name, x, *measured, setting)


def _together(batches: Mapping[str, Sequence[Measured]], each_run: bool) -> dict[str, Measured]:
    """Returns the measurements of all batches, by the names of the lines."""
    found: dict[str, Measured] = {}
    for name, parts in batches.items():
        samples, truncated, diverged = zip(*parts, strict=True)
        whole = Measured(np.concatenate(samples), sum(truncated), sum(diverged))
        if each_run:
            found |= {f"{name} {run + 1}": whole._replace(samples=row[None]) for run, row in enumerate(whole.samples)}
        else:
            found[name] = whole
    return found


MAX_EPISODE_STEPS = 5_000
"""The default time limit of an experiment."""


@dataclass(frozen=True, kw_only=True, repr=False)
class TrainingExperiment(MeasuredExperiment):
    """An experiment that trains settings with many seeds."""

    counts_failures = True

    settings: Sequence[Setting]
    max_episode_steps: int = MAX_EPISODE_STEPS
    """Episodes are truncated after this many steps. The book has no time limit."""

    def conditions(self, counts: Collection[int], runs: int, seed: int) -> str:
        """Describes in words how a result was computed; see ``Description.conditions``."""
        limit = f"episodes are truncated at {self.max_episode_steps:,} steps"
        return f"{super().conditions(counts, runs, seed)}; {limit}"

    def config(self, setting: Setting) -> dict[str, Any]:
        """Returns the keyword arguments of :func:`qtab.train` for a setting, without the seed."""
        return {"max_episode_steps": self.max_episode_steps, **setting.config}

    def _measure(self, setting: Setting, seeds: range, threads: int) -> Mapping[str, Measured]:
        """Trains a setting with each seed."""
        log = runner.train_runs(setting.env, self.config(setting), seeds, threads)
        # A point of a learning curve is made from one episode of each run, any other point from all episodes.
        truncated = log.truncated.sum(axis=0) if setting.x is None else log.truncated.sum()
        return {setting.line: Measured(setting.measure(log), truncated, int(log.diverged.sum()))}
