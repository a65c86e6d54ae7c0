"""An experiment that estimates the values of a policy and makes a line of the figure from each setting."""

import dataclasses
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import gymnasium as gym
import numpy as np

from qtab._utils.memory import memory_limit
from qtab._utils.progress import ProgressBar
from qtab.book.drawing import draw_lines, title_figure
from qtab.book.experiment import Experiment
from qtab.book.result import Draw, Line, Result
from qtab.book.runner import FloatArray
from qtab.planning.policies import GivenPolicy
from qtab.planning.policy_values import PolicyValues
from qtab.plots.axes import shown_figure
from qtab.prediction.estimates import ValueEstimates
from qtab.prediction.runs import recorded_episodes, run_prediction
from qtab.prediction.settings import PredictionSettings
from qtab.prediction.task import resolve_prediction

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
                for number, row in enumerate(samples if setting.each_run else ()):
                    name = f"{setting.line} {number + 1}"
                    parts[name] = [dataclasses.replace(_line(setting, row[None], diverged), name=name)]
                if not setting.each_run:
                    parts.setdefault(setting.line, []).append(_line(setting, samples, diverged))
        lines = tuple(map(_joined, parts.values()))
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


def _line(setting: PredictionSetting, samples: FloatArray, diverged: int) -> Line:
    """Returns the line through the points of one setting; ``samples`` is (runs, points)."""
    runs, points = samples.shape
    with np.errstate(invalid="ignore", over="ignore"):  # runs that diverged have infinite errors
        error = samples.std(axis=0, ddof=1) / np.sqrt(runs) if runs > 1 else np.full(points, np.nan)
    return Line(
        name=setting.line,
        x=np.array(setting.x, np.float64),
        mean=samples.mean(axis=0),
        error=error,
        runs=runs,
        truncated=np.zeros(points, np.int64),
        diverged=np.full(points, diverged),
        method=setting.method,
        dashed=setting.dashed,
        broad=setting.broad,
        named=not setting.each_run,
    )


def _joined(parts: list[Line]) -> Line:
    """Returns the points of several settings as one line."""
    names = ("x", "mean", "error", "truncated", "diverged")
    columns: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return dataclasses.replace(parts[0], **columns)


def draw_in_range(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the lines without bands around points far above the figure, where runs diverge; returns the axes."""
    top = 1.1 * (result.experiment.y_range or (0.0, np.inf))[1]
    lines = [dataclasses.replace(one, error=np.where(one.mean < top, one.error, np.nan)) for one in result.lines]
    lines = [dataclasses.replace(one, mean=np.where(one.mean < 1e3, one.mean, np.nan)) for one in lines]
    return draw_lines(dataclasses.replace(result, lines=tuple(lines)), ax)


@dataclass(frozen=True)
class Panel:
    """One of several axes side by side."""

    title: str
    lines: Callable[[str], bool]
    """Whether the line of a name belongs to it."""
    layout: Mapping[str, Any]
    """The fields of :class:`Description` that differ from those of the experiment."""


def draw_panels(panels: Sequence[Panel]) -> Draw:
    """Returns a function that draws each panel in axes of its own in a new figure, and returns the last axes."""

    def draw(result: Result, ax: "Axes | None") -> "Axes":
        if ax is not None:
            raise ValueError(f"ax must be None for {result.experiment.name}, which creates {len(panels)} axes")
        figure = shown_figure(6.5 * len(panels), 4.8)
        for index, panel in enumerate(panels):
            part = figure.add_subplot(1, len(panels), index + 1)
            lines = tuple(line for line in result.lines if panel.lines(line.name))
            experiment = dataclasses.replace(result.experiment, **panel.layout)
            ax = draw_in_range(dataclasses.replace(result, experiment=experiment, lines=lines), part)
            ax.set_title(panel.title, loc="left")
        title_figure(figure, result.experiment.heading)
        assert ax is not None  # noqa: S101 - there are panels
        return ax

    return draw
