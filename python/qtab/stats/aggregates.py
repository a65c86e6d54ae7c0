"""Scores over several environments, as rliable computes them (Agarwal et al., 2021)."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from qtab._utils import checks
from qtab.stats.intervals import CONFIDENCE, TRIMMED, Interval, sample

AGGREGATE_RESAMPLES = 2000

Scores = Mapping[str, ArrayLike] | ArrayLike


def _mean(*tasks: NDArray[np.float64]) -> float:
    return float(np.mean([np.mean(scores) for scores in tasks]))


def _median(*tasks: NDArray[np.float64]) -> float:
    return float(np.median([np.mean(scores) for scores in tasks]))


def _iqm(*tasks: NDArray[np.float64]) -> float:
    return float(stats.trim_mean(np.concatenate(tasks), TRIMMED))


AGGREGATES: Mapping[str, Callable[..., float]] = {"mean": _mean, "median": _median, "iqm": _iqm}
"""Mean and median of the tasks' means, and the interquartile mean of all runs of all tasks."""


def aggregate(
    scores: Scores,
    statistic: str = "iqm",
    *,
    confidence: float = CONFIDENCE,
    resamples: int = AGGREGATE_RESAMPLES,
    seed: int = 0,
) -> Interval:
    """Returns an aggregate over environments with its stratified bootstrap interval: each is resampled by itself.

    Args:
        scores: The normalised scores of each environment's runs, by name, or (runs, environments).
        statistic: ``"iqm"``, ``"mean"`` or ``"median"``.
        confidence: How often such an interval holds what it estimates.
        resamples: How many resamples the bootstrap takes.
        seed: Seeds the bootstrap.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    function = AGGREGATES[checks.choice("statistic", statistic, AGGREGATES)]
    return _stratified(_tasks(scores), function, confidence, resamples, seed)


def optimality_gap(
    scores: Scores,
    best: float = 1.0,
    *,
    confidence: float = CONFIDENCE,
    resamples: int = AGGREGATE_RESAMPLES,
    seed: int = 0,
) -> Interval:
    """Returns by how much the scores fall short of ``best`` on average, with its stratified bootstrap interval.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    best = checks.finite("best", best)

    def gap(*tasks: NDArray[np.float64]) -> float:
        return best - float(np.mean(np.minimum(np.concatenate(tasks), best)))

    return _stratified(_tasks(scores), gap, confidence, resamples, seed)


def performance_profile(scores: Scores, thresholds: ArrayLike) -> NDArray[np.float64]:
    """Returns, for each threshold, the share of runs that score above it, averaged over the environments.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    levels = sample("thresholds", thresholds)
    above = [np.mean(task[:, np.newaxis] > levels, axis=0) for task in _tasks(scores)]
    profile: NDArray[np.float64] = np.mean(above, axis=0)
    return profile


def _tasks(scores: Scores) -> list[NDArray[np.float64]]:
    if isinstance(scores, Mapping):
        tasks = [sample(f"scores[{name!r}]", values) for name, values in scores.items()]
    else:
        array = np.asarray(scores, dtype=np.float64)
        if array.ndim != 2:
            raise ValueError(f"scores must have the shape (runs, environments), got {array.shape}")
        tasks = [sample("scores", column) for column in array.T]
    if not tasks:
        raise ValueError("scores must hold at least one environment")
    return tasks


def _stratified(
    tasks: list[NDArray[np.float64]], function: Callable[..., float], confidence: float, resamples: int, seed: int
) -> Interval:
    confidence = checks.real("confidence", confidence, 0, 1)
    resamples = checks.integer("resamples", resamples, least=1)
    estimate = function(*tasks)
    if all(np.ptp(task) == 0 for task in tasks):
        return Interval(estimate, estimate, estimate, confidence, "constant")
    # scipy takes no sample of one number; resampled, it stays what it is.
    free = [index for index, task in enumerate(tasks) if len(task) > 1]

    def of_free(*resampled: NDArray[np.float64]) -> Any:
        mixed = list(tasks)
        for index, task in zip(free, resampled, strict=True):
            mixed[index] = task
        return function(*mixed)

    found = stats.bootstrap(
        [tasks[index] for index in free],
        of_free,
        vectorized=False,
        n_resamples=resamples,
        confidence_level=confidence,
        method="percentile",
        rng=np.random.default_rng(checks.integer("seed", seed, least=0)),
    ).confidence_interval
    return Interval(estimate, float(found.low), float(found.high), confidence, "stratified percentile")
