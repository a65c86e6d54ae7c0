"""An experiment on the k-armed testbed: many bandit problems, the reward and the choice of each step."""

import dataclasses
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from qtab import _core
from qtab.book.drawing import Panel, draw_lines, draw_panels
from qtab.book.line import Line, line_from_samples
from qtab.book.measured_experiment import Measured, MeasuredExperiment
from qtab.book.result import Draw, Result
from qtab.book.runner import FloatArray
from qtab.book.setting import LineSetting
from qtab.training.train_many import resolve_template

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Measure: TypeAlias = Literal["reward", "optimal"]
ENV = "qtab/KArmedBandit-v0"
LABELS: Mapping[Measure, str] = {"reward": "average reward", "optimal": "% optimal action"}
"""The y label of each measure."""
SAMPLE_AVERAGES = {"learning_rate": 1.0, "learning_rate_schedule": "visits"}
GREEDY: Mapping[str, Any] = {
    "exploration": "epsilon_greedy",
    "epsilon": 0.0,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
}


@dataclass(frozen=True)
class BanditSetting(LineSetting):
    """A method on the testbed."""

    line: str
    """The name of its line."""
    config: Mapping[str, Any]
    """The keyword arguments of :func:`qtab.train`, without the environment."""
    x: float | None = None
    """The x coordinate of its point in a parameter study; None for a curve over the steps."""


def draw_measures(result: Result, ax: "Axes | None") -> "Axes":
    """Draws a panel for each measure.

    Raises:
        ValueError: if there are several, and ``ax`` is not None.
    """
    experiment: Any = result.experiment
    if len(experiment.measures) == 1:
        return draw_lines(result, ax)
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


@dataclass(frozen=True, kw_only=True, repr=False)
class TestbedExperiment(MeasuredExperiment):
    """An experiment that draws a bandit problem for each seed, and applies each setting to all of them."""

    __test__ = False  # pytest would collect it because of its name
    BATCH_RUNS = 500

    settings: Sequence[BanditSetting]
    measures: Sequence[Measure] = ("reward", "optimal")
    """The measures, one for each panel of the figure."""
    mean: float = 0.0
    """The mean of the true values."""
    steps: int = 1000
    draw: Draw = draw_measures
    runs: int = 2000
    x_label: str = "step"

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        names = dict.fromkeys(setting.line for setting in self.settings)
        return tuple(self._line_name(name, measure) for measure in self.measures for name in names)

    def conditions(self, counts: Collection[int], runs: int, seed: int) -> str:
        """Describes in words how a result was computed; see :meth:`Description.conditions`."""
        return f"{super().conditions(counts, runs, seed)}; {self.steps:,} steps of each run"

    def config(self, setting: BanditSetting) -> dict[str, Any]:
        """Returns the keyword arguments of :func:`qtab.train` for a setting, without the seed."""
        return {
            "env_kwargs": {"mean": self.mean},
            "max_episode_steps": 1,
            "episodes": self.steps,
            **setting.config,
        }

    def _measure(self, setting: BanditSetting, seeds: range, threads: int) -> Mapping[str, Measured]:
        """Applies a setting to the problem of each seed."""
        found = dict(zip(LABELS, run_testbeds(self.config(setting), seeds, threads), strict=True))
        if setting.x is not None:
            found = {measure: samples.mean(axis=1, keepdims=True) for measure, samples in found.items()}
        return {self._line_name(setting.line, measure): Measured(found[measure]) for measure in self.measures}

    def _line(self, name: str, parts: Sequence[tuple[BanditSetting, Measured]]) -> Line:
        """Returns the line of a measure for the settings of a name, each a curve or a point."""
        first, _ = parts[0]
        x = [setting.x for setting, _ in parts if setting.x is not None] or np.arange(1, self.steps + 1)
        samples = np.concatenate([measured.samples for _, measured in parts], axis=1)
        return line_from_samples(name, x, samples, style=dataclasses.replace(first, method=first.method or first.line))

    def _line_name(self, name: str, measure: Measure) -> str:
        return name if len(self.measures) == 1 else f"{name}: {LABELS[measure]}"


def run_testbeds(config: Mapping[str, Any], seeds: Sequence[int], threads: int) -> tuple[FloatArray, FloatArray]:
    """Trains one run per seed, each on the problem of its seed, with the same numbers as :func:`qtab.train`.

    Returns:
        (runs, steps) rewards, and (runs, steps): 100 where the action was optimal, else 0.
    """
    resolved = resolve_template(ENV, {**config, "seed": seeds[0]})
    shape = (len(seeds), resolved.config.episodes)
    rewards, optimal = np.empty(shape), np.empty(shape, np.bool_)
    _core.run_testbeds(resolved.spec(), list(seeds), rewards, optimal, threads)
    # One array, as most of the time of a large array goes into its memory pages.
    percentages: FloatArray = np.multiply(optimal, 100.0)
    return rewards, percentages
