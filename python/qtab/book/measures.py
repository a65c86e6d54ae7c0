"""Measures of runs: functions of the episodes of many runs that return (runs, points)."""

import numpy as np

from qtab.book.runner import EpisodeLog, FloatArray
from qtab.book.setting import Measure
from qtab.results.summary import FINAL_EPISODES


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
