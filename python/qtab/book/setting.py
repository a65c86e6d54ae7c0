"""One setting of an experiment: a config that is trained many times, and a measure of the runs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from qtab.book.line import LineStyle
from qtab.book.runner import EpisodeLog, FloatArray
from qtab.training.train_many import MakeEnv

Measure: TypeAlias = Callable[[EpisodeLog], FloatArray]
"""A function of the episodes of many runs that returns (runs, points)."""


@dataclass(frozen=True, kw_only=True)
class LineSetting(LineStyle):
    """The fields that the settings of all experiments have."""

    max_runs: int | None = None
    """The maximum number of runs, if the book has fewer runs of this setting than of the others."""
    each_run: bool = False
    """Whether each run is a separate line, with the number of the run in its name."""


@dataclass(frozen=True)
class Setting(LineSetting):
    """A config that is trained with many seeds, and the points of a line that are measured from it."""

    line: str
    """The name of the line that its points belong to."""
    env: str | MakeEnv
    """The environment's id, or a function that creates it."""
    config: Mapping[str, Any]
    """The keyword arguments of :func:`qtab.train`."""
    measure: Measure
    x: tuple[float, ...] | None = None
    """The x coordinates of its points; None means the numbers of the episodes, from 1."""
