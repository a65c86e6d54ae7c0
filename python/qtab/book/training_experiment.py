"""An experiment that trains its settings and makes a line of the figure from each."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from qtab.book import runner
from qtab.book.measured_experiment import Measured, MeasuredExperiment
from qtab.book.setting import Setting

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
