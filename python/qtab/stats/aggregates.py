"""Statistics of scores on several environments, as in rliable (Agarwal et al., 2021)."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from qtab._utils import checks
from qtab.stats.intervals import CONFIDENCE, TRIM_FRACTION, Interval, as_sample

AGGREGATE_RESAMPLES = 2000

Scores = Mapping[str, ArrayLike] | ArrayLike
"""The scores of each environment by name, (runs,) each, or an array (runs, environments)."""


def _mean(*samples: NDArray[np.float64]) -> float:
    return float(np.mean([np.mean(sample) for sample in samples]))


def _median(*samples: NDArray[np.float64]) -> float:
    return float(np.median([np.mean(sample) for sample in samples]))


def _iqm(*samples: NDArray[np.float64]) -> float:
    return float(stats.trim_mean(np.concatenate(samples), TRIM_FRACTION))


AGGREGATES: Mapping[str, Callable[..., float]] = {"mean": _mean, "median": _median, "iqm": _iqm}
"""The mean and the median of the environments' means, and the interquartile mean of all runs on all environments."""


def aggregate(
    scores: Scores,
    statistic: str = "iqm",
    *,
    confidence: float = CONFIDENCE,
    resamples: int = AGGREGATE_RESAMPLES,
    seed: int = 0,
) -> Interval:
    """Returns an aggregate over environments with its stratified bootstrap interval.

    The bootstrap is stratified: it resamples the runs of each environment separately.

    Args:
        scores: The normalized scores of each environment by name, (runs,) each, or an array (runs, environments).
        statistic: ``"iqm"``, ``"mean"`` or ``"median"``.
        confidence: The coverage probability of the interval, in [0, 1].
        resamples: The number of bootstrap resamples.
        seed: Seeds the bootstrap.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    function = AGGREGATES[checks.choice("statistic", statistic, AGGREGATES)]
    return _stratified(_samples(scores), function, confidence, resamples, seed)


def optimality_gap(
    scores: Scores,
    best: float = 1.0,
    *,
    confidence: float = CONFIDENCE,
    resamples: int = AGGREGATE_RESAMPLES,
    seed: int = 0,
) -> Interval:
    """Returns the mean amount by which scores fall short of ``best``, with its stratified bootstrap interval.

    Scores above ``best`` count as ``best``. See :func:`aggregate` for the other arguments.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    best = checks.finite("best", best)

    def gap(*samples: NDArray[np.float64]) -> float:
        return best - float(np.mean(np.minimum(np.concatenate(samples), best)))

    return _stratified(_samples(scores), gap, confidence, resamples, seed)


def performance_profile(scores: Scores, thresholds: ArrayLike) -> NDArray[np.float64]:
    """Returns (thresholds,): the proportion of runs that score above each threshold, averaged over the environments.

    Args:
        scores: The scores of each environment by name, (runs,) each, or an array (runs, environments).
        thresholds: (thresholds,) float.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    levels = as_sample("thresholds", thresholds)
    above = [np.mean(sample[:, np.newaxis] > levels, axis=0) for sample in _samples(scores)]
    profile: NDArray[np.float64] = np.mean(above, axis=0)
    return profile


def _samples(scores: Scores) -> list[NDArray[np.float64]]:
    """Returns the scores of each environment."""
    if isinstance(scores, Mapping):
        samples = [as_sample(f"scores[{name!r}]", values) for name, values in scores.items()]
    else:
        array = np.asarray(scores, dtype=np.float64)
        if array.ndim != 2:
            raise ValueError(f"scores must have the shape (runs, environments), got {array.shape}")
        samples = [as_sample("scores", column) for column in array.T]
    if not samples:
        raise ValueError("scores must hold at least one environment")
    return samples


def _stratified(
    samples: list[NDArray[np.float64]], function: Callable[..., float], confidence: float, resamples: int, seed: int
) -> Interval:
    confidence = checks.real("confidence", confidence, 0, 1)
    resamples = checks.integer("resamples", resamples, least=1)
    estimate = function(*samples)
    if all(np.ptp(sample) == 0 for sample in samples):
        return Interval(estimate, estimate, estimate, confidence, "constant")
    # SciPy refuses samples of one number. Resampling would not change them, so they are left out and put back.
    several = [index for index, sample in enumerate(samples) if len(sample) > 1]

    def statistic(*resampled: NDArray[np.float64]) -> Any:
        completed = list(samples)
        for index, sample in zip(several, resampled, strict=True):
            completed[index] = sample
        return function(*completed)

    interval = stats.bootstrap(
        [samples[index] for index in several],
        statistic,
        vectorized=False,
        n_resamples=resamples,
        confidence_level=confidence,
        method="percentile",
        rng=np.random.default_rng(checks.integer("seed", seed, least=0)),
    ).confidence_interval
    return Interval(estimate, float(interval.low), float(interval.high), confidence, "stratified percentile")
