"""What an experiment of the book is: settings, what is measured of each, and the lines that they make."""

import dataclasses
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.progress import ProgressBar
from qtab.book import trials
from qtab.book.trials import Environment, Outcome
from qtab.training.train_many import thread_count

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CAP = 5_000
"""An episode of an experiment ends after so many steps, if the experiment says nothing else."""
RUNS_AT_ONCE = 5_000
"""So many runs are kept before they are measured: the bar moves, and memory stays small."""

Numbers: TypeAlias = NDArray[np.float64]
Measure: TypeAlias = Callable[[Outcome], Numbers]
"""From the outcome to (runs, points)."""


@dataclass(frozen=True)
class Setting:
    """One thing that is run many times."""

    line: str
    """The line of the figure that it belongs to."""
    env: Environment
    config: Mapping[str, Any]
    """What :func:`qtab.train` is given."""
    measure: Measure
    x: tuple[float, ...] | None = None
    """Where its points lie; None means episodes, from the first."""
    most_runs: int | None = None
    """The book's count, where it is less than the experiment's."""
    drawn: bool = True
    """Whether the picture shows it."""


@dataclass(frozen=True, eq=False)
class Line:
    """A line of a figure: a point for each x."""

    name: str
    x: Numbers
    mean: Numbers
    """Over the runs."""
    error: Numbers
    """The standard error of each mean; NaN where there is one run."""
    runs: int
    capped: NDArray[np.int64]
    """At each point, how many of its episodes were capped."""
    diverged: NDArray[np.int64]
    """At each point, how many runs of its setting diverged."""
    drawn: bool = True


@dataclass(frozen=True, eq=False)
class Result:
    """What an experiment brought. ``str`` of it is the table."""

    experiment: "Experiment"
    lines: tuple[Line, ...]
    runs: int
    seed: int
    seconds: float
    extra: Any = field(default=None, repr=False)
    """What a picture needs beside the lines."""

    def __str__(self) -> str:
        """The table, with the settings above it."""
        from qtab.book.result import table

        return table(self)

    def save(self, path: Path | str) -> None:
        """Writes all points to a CSV file.

        Raises:
            OSError: if it cannot be written.
        """
        from qtab.book.result import save

        save(self, Path(path))

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draws the figure and returns the axes.

        Raises:
            ModuleNotFoundError: without matplotlib; it names the ``pip install``.
        """
        return self.experiment.draw(self, ax)


@dataclass(frozen=True)
class Experiment:
    """An experiment of the book, and how its figure is drawn."""

    name: str
    """"figure-10.4"."""
    title: str
    book: str
    """What the book says of the settings."""
    silent: str
    """What it leaves open, and what is done here."""
    settings: Sequence[Setting]
    runs: int
    """Of each setting, as in the book."""
    x: str
    y: str
    shown: tuple[float, ...] | None = None
    """The points that the table shows; None means all."""
    cap: int = CAP
    log_y: bool = False
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None

    @property
    def number(self) -> str:
        """The book's number."""
        return self.name.partition("-")[2]

    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Runs every setting; see :func:`qtab.book.run`."""
        count, seed, workers = self.check(runs, seed, threads)
        began = time.perf_counter()
        counts = [min(count, setting.most_runs or count) for setting in self.settings]
        parts: dict[str, list[Line]] = {}
        with ProgressBar(sum(counts), "run", progress, self.name) as shown:
            done = 0
            for setting, own in zip(self.settings, counts, strict=True):
                point = _Point(setting)
                for first in range(0, own, RUNS_AT_ONCE):
                    seeds = range(seed + first, seed + min(first + RUNS_AT_ONCE, own))
                    point.add(trials.train(setting.env, self.config(setting), seeds, workers))
                    done += len(seeds)
                    shown.move_to(done)
                parts.setdefault(setting.line, []).append(point.line())
        lines = tuple(map(_joined, parts.values()))
        return Result(self, lines, count, seed, time.perf_counter() - began)

    def check(self, runs: int | None, seed: int, threads: int | None) -> tuple[int, int, int]:
        """Returns how many runs of each setting there will be, their first seed, and how many threads.

        Raises:
            TypeError: for an argument of the wrong type.
            ValueError: for an argument out of range.
        """
        count = self.runs if runs is None else checks.integer("runs", runs, least=1)
        return count, checks.integer("seed", seed, least=0), thread_count(threads)

    def config(self, setting: Setting) -> dict[str, Any]:
        """Returns what a run of a setting is trained with, but for its seed."""
        return {"max_episode_steps": self.cap, **setting.config}

    def draw(self, result: Result, ax: "Axes | None" = None) -> "Axes":
        """Draws the lines of a result; see :meth:`Result.plot`."""
        from qtab.book.drawing import draw_lines

        return draw_lines(result, ax)


class _Point:
    """A setting's numbers, gathered from one lot of runs to the next."""

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self.samples: list[Numbers] = []
        self.capped: NDArray[np.int64] = np.zeros(1, np.int64)
        self.diverged = 0

    def add(self, outcome: Outcome) -> None:
        self.samples.append(self.setting.measure(outcome))
        # A curve has a point for each episode; elsewhere each point is made of them all.
        self.capped = self.capped + (outcome.capped.sum(axis=0) if self.setting.x is None else outcome.capped.sum())
        self.diverged += int(outcome.diverged.sum())

    def line(self) -> Line:
        """Returns it as a line of its own."""
        samples = np.concatenate(self.samples)
        return line(self.setting, samples, self.capped, self.diverged)


def line(setting: Setting, samples: Numbers, capped: "NDArray[np.int64] | int", diverged: int) -> Line:
    """Returns the line of one setting.

    Args:
        setting: Whose it is.
        samples: (runs, points): what was measured.
        capped: How many episodes were capped, of all or of each point.
        diverged: How many runs diverged.
    """
    runs, width = samples.shape
    error = samples.std(axis=0, ddof=1) / np.sqrt(runs) if runs > 1 else np.full(width, np.nan)
    x = np.arange(1.0, width + 1) if setting.x is None else np.array(setting.x, np.float64)
    counts = np.broadcast_to(capped, width), np.broadcast_to(diverged, width)
    return Line(setting.line, x, samples.mean(axis=0), error, runs, *counts, setting.drawn)


def _joined(parts: list[Line]) -> Line:
    """The lines of several settings, one after the other, as one."""
    names = ("x", "mean", "error", "capped", "diverged")
    columns: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return dataclasses.replace(parts[0], **columns)
