"""An experiment that estimates the values of a policy and makes a line of the figure from each setting."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np

from qtab.book.measured_experiment import Measured, MeasuredExperiment
from qtab.book.runner import FloatArray
from qtab.book.setting import LineSetting
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
class PredictionSetting(LineSetting):
    """A method with its options, run with many seeds, and the points of a line that are measured from it."""

    line: str
    """The name of the line that its points belong to."""
    task: Callable[[], PredictionTask]
    """Returns the task, the same at each call."""
    arguments: Mapping[str, Any]
    """The keyword arguments of :func:`qtab.estimate_values`, without the seeds."""
    measure: Measure
    x: tuple[float, ...]
    """The x coordinates of its points."""


class PredictionExperiment(MeasuredExperiment):
    """An experiment that estimates values with many seeds."""

    def _measure(self, setting: PredictionSetting, seeds: range, threads: int) -> Mapping[str, Measured]:
        """Estimates the values with each seed."""
        task = setting.task()
        estimates, diverged = _estimate(task, setting.arguments, seeds, threads)
        return {setting.line: Measured(setting.measure(estimates, task.true_values), 0, diverged)}


def _estimate(
    task: PredictionTask, arguments: Mapping[str, Any], seeds: range, threads: int
) -> tuple[ValueEstimates, int]:
    """Returns the estimates, with infinite values after a run diverged, and the number of runs that diverged."""
    options = dict(arguments)
    behavior, features, record = (options.pop(name, None) for name in ("behavior", "features", "record"))
    settings = PredictionSettings(**options)
    points = recorded_episodes(record, settings.episodes)
    resolved, space = resolve_prediction(task.env, task.policy, settings, seeds[0], {})
    estimates, failed = run_prediction(
        resolved, space, settings, task.policy, behavior, features, seeds, points, threads
    )
    for _, error in failed:
        if not isinstance(error, OverflowError):
            raise error
    estimates.weights[np.isnan(estimates.weights)] = np.inf
    return estimates, len(failed)
