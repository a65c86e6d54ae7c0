"""One setting of an experiment: a config that is trained many times, and a measure of the runs.

Measures are functions of the episodes of many runs that return (runs, points).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from qtab.book.line import LineStyle
from qtab.book.runner import EpisodeLog, FloatArray
from qtab.results.summary import FINAL_EPISODES
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


def lengths(log: EpisodeLog) -> FloatArray:
    """Returns (runs, episodes): the number of steps of each episode."""
    return log.lengths.astype(np.float64)


def returns(log: EpisodeLog) -> FloatArray:
    """Returns (runs, episodes): the undiscounted return of each episode."""
    return log.returns


def mean_length(log: EpisodeLog) -> FloatArray:
    """Returns (runs, 1): the mean number of steps per episode."""
    means: FloatArray = log.lengths.mean(axis=1, keepdims=True)
    return means


def mean_return(log: EpisodeLog) -> FloatArray:
    """Returns (runs, 1): the mean return."""
    means: FloatArray = log.returns.mean(axis=1, keepdims=True)
    return means


def final_return(log: EpisodeLog) -> FloatArray:
    """Returns (runs, 1): the mean return of the last 100 episodes."""
    means: FloatArray = log.returns[:, -FINAL_EPISODES:].mean(axis=1, keepdims=True)
    return means


def reward_by(times: tuple[int, ...]) -> Measure:
    """Returns the measure (runs, times): how often the goal, with a reward of 1, was reached by each time step."""

    def measure(log: EpisodeLog) -> FloatArray:
        ends = np.where(log.truncated, times[-1] + 1, log.lengths.cumsum(axis=1))
        return np.stack([(ends <= time).sum(axis=1) for time in times], axis=1).astype(np.float64)

    return measure


def episodes_by(times: tuple[int, ...]) -> Measure:
    """Returns the measure (runs, times): the number of episodes that ended by each time step."""

    def measure(log: EpisodeLog) -> FloatArray:
        ends = log.lengths.cumsum(axis=1)
        return np.stack([(ends <= time).sum(axis=1) for time in times], axis=1).astype(np.float64)

    return measure
