"""Statistics of scores on several environments, as in rliable (Agarwal et al., 2021).

Every environment has the same weight, even one with fewer runs: a run has the weight 1 / (number of runs on its
environment). With equal numbers of runs, which rliable requires, this makes no difference.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.stats.bootstrap import bootstrap
from qtab.stats.interval import Interval
from qtab.stats.intervals import CONFIDENCE, TRIM_FRACTION, interquartile_mean
from qtab.stats.scores import Scores, as_samples

AGGREGATE_RESAMPLES = 2000


def _mean(*samples: NDArray[np.float64]) -> float:
    return float(np.mean([np.mean(sample) for sample in samples]))


def _median(*samples: NDArray[np.float64]) -> float:
    return float(np.median([np.mean(sample) for sample in samples]))


def _iqm(*samples: NDArray[np.float64]) -> float:
    values = np.concatenate(samples)
    if len({len(sample) for sample in samples}) == 1:
        return float(interquartile_mean(values))
    weights = np.concatenate([np.full(len(sample), 1 / len(sample)) for sample in samples])
    order = np.argsort(values, kind="stable")
    values, weights = values[order], weights[order]
    most = TRIM_FRACTION * len(samples) + ROUNDING
    # As without weights, all of a value on the border of a quarter is kept.
    is_kept = (np.cumsum(weights) > most) & (np.cumsum(weights[::-1])[::-1] > most)
    return float(np.average(values[is_kept], weights=weights[is_kept]))


AGGREGATES: Mapping[str, Callable[..., float]] = {"mean": _mean, "median": _median, "iqm": _iqm}
"""The mean and the median of the environments' means, and the interquartile mean of all runs on all environments."""
ROUNDING = 1e-9
"""More than the rounding error of a sum of weights, and less than the weight of a run."""


def aggregate(
    scores: Scores,
    statistic: str = "iqm",
    *,
    confidence: float = CONFIDENCE,
    resamples: int = AGGREGATE_RESAMPLES,
    seed: int = 0,
) -> Interval:
    """Returns an aggregate over environments with its stratified bootstrap interval.

    Every environment has the same weight, whatever its number of runs. The interquartile mean leaves out the lowest and
    the highest quarter of the runs of all environments, weighted in this way.

    The bootstrap is stratified: it resamples the runs of each environment separately. With few runs of few
    environments it is too narrow, like every bootstrap interval: see :func:`mean` and :func:`iqm` for measured figures.

    Args:
        scores: The normalized scores of each environment by name, (runs,) each, or an array (runs, environments); at
            least two runs of each environment.
        statistic: ``"iqm"``, ``"mean"`` or ``"median"``.
        confidence: The coverage probability of the interval, between 0 and 1.
        resamples: The number of bootstrap resamples, at most a million.
        seed: Seeds the bootstrap.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    function = AGGREGATES[checks.choice("statistic", statistic, AGGREGATES)]
    samples = as_samples("scores", scores, least=2)
    return bootstrap(samples, function, confidence, resamples, seed, stratified=True)


def optimality_gap(
    scores: Scores,
    best: float = 1.0,
    *,
    confidence: float = CONFIDENCE,
    resamples: int = AGGREGATE_RESAMPLES,
    seed: int = 0,
) -> Interval:
    """Returns the mean amount by which scores fall short of ``best``, with its stratified bootstrap interval.

    Scores above ``best`` count as ``best``, and every environment has the same weight, whatever its number of runs. See
    :func:`aggregate` for the other arguments.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    best = checks.finite("best", best)

    def gap(*samples: NDArray[np.float64]) -> float:
        return best - _mean(*(np.minimum(sample, best) for sample in samples))

    return bootstrap(as_samples("scores", scores, least=2), gap, confidence, resamples, seed, stratified=True)
