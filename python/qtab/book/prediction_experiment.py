"""An experiment that estimates the values of a policy and makes a line of the figure from each setting."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np

from qtab._utils.memory import memory_limit
from qtab._utils.progress import ProgressBar
from qtab.book.drawing import draw_lines
from qtab.book.experiment import Experiment
from qtab.book.line import Line, joined, line_from_samples
from qtab.book.result import Draw, Result
from qtab.book.runner import FloatArray
from qtab.planning.policies import GivenPolicy
from qtab.planning.policy_values import PolicyValues
from qtab.prediction.estimates import ValueEstimates
from qtab.prediction.runs import recorded_episodes, run_prediction
from qtab.prediction.settings import PredictionSettings
from qtab.prediction.task import resolve_prediction


@dataclass(frozen=True)
class PredictionTask:
    """A policy in an environment, and its exact values."""

    env: gym.Env
    policy: GivenPolicy
    true_values: PolicyValues


Measure: TypeAlias = Callable[[ValueEstimates, PolicyValues], FloatArray]
"""A function of the estimates and the exact values that returns (runs, points)."""


@dataclass(frozen=True)
class PredictionSetting:
    """A method with its options, run with many seeds, and the points of a line that are measured from it."""

    line: str
    """The name of the line that its points belong to."""
    task: Callable[[], PredictionTask]
    """Returns what is estimated, the same at each call."""
    arguments: Mapping[str, Any]
    """The keyword arguments of :func:`qtab.estimate_values`, without the seeds."""
    measure: Measure
    x: tuple[float, ...]
    """The x coordinates of its points."""
    max_runs: int | None = None
    """The maximum number of runs, where the book has fewer runs of this setting than of the others."""
    method: str = ""
    """The method that decides the color of the line; empty means the name of the line."""
    dashed: bool = False
    """Whether the line is dashed."""
    broad: bool = False
    """Whether the line is a broad one behind the others."""
    each_run: bool = False
    """Whether each run is a line of its own. The table calls it by the name and its number, the figure does not."""


@dataclass(frozen=True, kw_only=True, repr=False)
class PredictionExperiment(Experiment):
    """An experiment that estimates values with many seeds."""

    settings: Sequence[PredictionSetting]
    draw: Draw = draw_lines
    """Draws the figure."""

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        names: list[str] = []
        for setting in self.settings:
            names += [f"{setting.line} {run + 1}" for run in range(self.runs)] if setting.each_run else [setting.line]
        return tuple(dict.fromkeys(names))

    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Estimates with every setting and every seed; see :func:`qtab.book.run`."""
        runs, seed, threads = self.check_arguments(runs, seed, threads)
        started = time.perf_counter()
        parts: dict[str, list[Line]] = {}
        counts = [min(runs, setting.max_runs or runs) for setting in self.settings]
        with ProgressBar(sum(counts), "run", progress, self.name) as bar:
            done = 0
            for setting, count in zip(self.settings, counts, strict=True):
                task = setting.task()
                # Runs that are lines of their own are long: the bar moves as often as all threads are through with one.
                size = threads if setting.each_run else count
                measured, diverged = [], 0
                for first in range(0, count, size):
                    seeds = range(seed + first, seed + min(first + size, count))
                    estimates, failed = _estimate(task, setting.arguments, seeds, threads)
                    measured.append(setting.measure(estimates, task.true_values))
                    diverged += failed
                    done += len(seeds)
                    bar.move_to(done)
                samples = np.concatenate(measured)
                named = {setting.line: samples}
                if setting.each_run:
                    named = {f"{setting.line} {number}": row[np.newaxis] for number, row in enumerate(samples, 1)}
                for name, rows in named.items():
                    parts.setdefault(name, []).append(_line(setting, name, rows, diverged))
        lines = tuple(map(joined, parts.values()))
        return Result(self, lines, runs, seed, time.perf_counter() - started, self.draw)


def _estimate(
    task: PredictionTask, arguments: Mapping[str, Any], seeds: range, threads: int
) -> tuple[ValueEstimates, int]:
    """Returns the estimates, and how many runs diverged; of these, the values are infinite from then on."""
    options = dict(arguments)
    behavior, features, record = (options.pop(name, None) for name in ("behavior", "features", "record"))
    settings = PredictionSettings(**options)
    points, limit = recorded_episodes(record, settings.episodes), memory_limit(None)
    resolved, space = resolve_prediction(task.env, task.policy, settings, seeds[0], {})
    estimates, failed = run_prediction(
        resolved, space, settings, task.policy, behavior, features, seeds, points, threads, limit
    )
    for _, error in failed:
        if not isinstance(error, OverflowError):
            raise error
    estimates.weights[np.isnan(estimates.weights)] = np.inf
    return estimates, len(failed)


def _line(setting: PredictionSetting, name: str, samples: FloatArray, diverged: int) -> Line:
    """Returns the line through the points of one setting; ``samples`` is (runs, points)."""
    style: dict[str, Any] = {"method": setting.method, "dashed": setting.dashed, "broad": setting.broad}
    return line_from_samples(name, setting.x, samples, 0, diverged, **style, named=not setting.each_run)
