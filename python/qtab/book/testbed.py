"""An experiment on the k-armed testbed: many bandit problems, the reward and the choice of each step."""

import dataclasses
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from qtab import _core
from qtab._utils.progress import ProgressBar
from qtab.book.drawing import Panel, draw_lines, draw_panels, label_tops
from qtab.book.experiment import Experiment
from qtab.book.line import Line, line_from_samples
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.training.train_many import resolve_template

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Measure: TypeAlias = Literal["reward", "optimal"]
ENV = "qtab/KArmedBandit-v0"
BATCH_RUNS = 500
"""Problems are trained in batches of this size, which bounds the memory and moves the progress bar."""
LABELS: Mapping[Measure, str] = {"reward": "average reward", "optimal": "% optimal action"}
"""What each measure is called."""
SAMPLE_AVERAGES = {"learning_rate": 1.0, "learning_rate_schedule": "visits"}
GREEDY: Mapping[str, Any] = {
    "exploration": "epsilon_greedy",
    "epsilon": 0.0,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
}


@dataclass(frozen=True)
class BanditSetting:
    """A method on the testbed."""

    line: str
    """The name of its line."""
    config: Mapping[str, Any]
    """The keyword arguments of :func:`qtab.train`, without the environment."""
    x: float | None = None
    """Where its point is on the x axis of a parameter study; None for a curve over the steps."""
    method: str = ""
    """The method that decides the color of the line; empty means the name of the line."""
    dashed: bool = False
    """Whether the line is dashed."""


@dataclass(frozen=True, kw_only=True, repr=False)
class TestbedExperiment(Experiment):
    """An experiment that draws a bandit problem for each seed, and applies each setting to all of them."""

    __test__ = False  # not a test, whatever pytest thinks of its name

    settings: Sequence[BanditSetting]
    measures: Sequence[Measure] = ("reward", "optimal")
    """What is measured: each has a panel of the figure."""
    mean: float = 0.0
    """The mean of the true values."""
    steps: int = 1000

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        names = dict.fromkeys(setting.line for setting in self.settings)
        return tuple(self._line_name(name, measure) for measure in self.measures for name in names)

    def conditions(self, counts: Collection[int], runs: int, seed: int) -> str:
        """Returns how a result was made, in words; see :meth:`Description.conditions`."""
        return f"{super().conditions(counts, runs, seed)}; {self.steps:,} steps of each run"

    def config(self, setting: BanditSetting) -> dict[str, Any]:
        """Returns the keyword arguments of :func:`qtab.train` for a setting, without the seed."""
        return {
            "env_kwargs": {"mean": self.mean},
            "max_episode_steps": 1,
            "episodes": self.steps,
            **setting.config,
        }

    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Applies every setting to the problem of every seed; see :func:`qtab.book.run`."""
        runs, seed, threads = self.check_arguments(runs, seed, threads)
        started = time.perf_counter()
        samples: dict[str, list[FloatArray]] = {name: [] for name in self.line_names}
        with ProgressBar(runs * len(self.settings), "run", progress, self.name) as bar:
            for number, setting in enumerate(self.settings):
                batches: dict[Measure, list[FloatArray]] = {measure: [] for measure in self.measures}
                for first in range(0, runs, BATCH_RUNS):
                    seeds = range(seed + first, seed + min(first + BATCH_RUNS, runs))
                    rewards, optimal = run_testbeds(self.config(setting), seeds, threads)
                    for measure, measured in (("reward", rewards), ("optimal", optimal)):
                        if measure in batches:
                            point = measured if setting.x is None else measured.mean(axis=1, keepdims=True)
                            batches[measure].append(point)
                    bar.move_to(number * runs + first + len(seeds))
                for measure, parts in batches.items():
                    samples[self._line_name(setting.line, measure)].append(np.concatenate(parts))
        lines = tuple(self._line(name, measured) for name, measured in samples.items())
        return Result(self, lines, runs, seed, time.perf_counter() - started, draw)

    def _line_name(self, name: str, measure: Measure) -> str:
        return name if len(self.measures) == 1 else f"{name}: {LABELS[measure]}"

    def _line(self, name: str, samples: Sequence[FloatArray]) -> Line:
        """The line of a measure of the settings of that name, each a curve or a point."""
        settings = [one for one in self.settings if name.removeprefix(one.line) in ("", *self._suffixes)]
        points = [one.x for one in settings if one.x is not None] or np.arange(1, self.steps + 1)
        first = settings[0]
        style: dict[str, Any] = {"method": first.method or first.line, "dashed": first.dashed}
        return line_from_samples(name, points, np.concatenate(samples, axis=1), **style)

    @property
    def _suffixes(self) -> Sequence[str]:
        return [f": {LABELS[measure]}" for measure in self.measures]


def draw(result: Result, ax: "Axes | None") -> "Axes":
    """Draws a panel for each measure.

    Raises:
        ValueError: if there are several, and ``ax`` is not None.
    """
    experiment = result.experiment
    assert isinstance(experiment, TestbedExperiment)  # noqa: S101
    if len(experiment.measures) == 1:
        axes = draw_lines(result, ax)
        if experiment.x_ticks is not None:
            axes.set_xticks(experiment.x_ticks, [_power_of_two(tick) for tick in experiment.x_ticks])
            label_tops(axes, result.lines)
        return axes
    panels = []
    for measure in experiment.measures:
        suffix = f": {LABELS[measure]}"
        lines = tuple(
            dataclasses.replace(line, name=line.name.removesuffix(suffix))
            for line in result.lines
            if line.name.endswith(suffix)
        )
        y_range = (0.0, 100.0) if measure == "optimal" else experiment.y_range
        panels.append(Panel("", lines, {"y_label": LABELS[measure], "y_range": y_range}))
    return draw_panels(result, ax, panels, shared_x=True)


def _power_of_two(number: float) -> str:
    return f"1/{1 / number:g}" if number < 1 else f"{number:g}"


def run_testbeds(config: Mapping[str, Any], seeds: Sequence[int], threads: int) -> tuple[FloatArray, FloatArray]:
    """Trains one run per seed, each on the problem of its seed, with the numbers of :func:`qtab.train`.

    Returns:
        (runs, steps) rewards, and (runs, steps): 100 where the action was optimal, else 0.
    """
    resolved = resolve_template(ENV, {**config, "seed": seeds[0]})
    shape = (len(seeds), resolved.config.episodes)
    rewards, optimal = np.empty(shape), np.empty(shape, np.bool_)
    _core.run_testbeds(resolved.spec(), list(seeds), rewards, optimal, threads)
    # One array: the time of a large array is that of its memory pages.
    percentages: FloatArray = np.multiply(optimal, 100.0)
    return rewards, percentages
