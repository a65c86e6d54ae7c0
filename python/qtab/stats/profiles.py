"""Performance profiles (Agarwal et al., 2021)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import arrays, checks
from qtab.stats.aggregates import AGGREGATE_RESAMPLES
from qtab.stats.bootstrap import BATCH_VALUES, as_confidence, as_resamples
from qtab.stats.interval import Interval
from qtab.stats.intervals import CONFIDENCE
from qtab.stats.scores import Scores, as_samples

MAX_THRESHOLDS = 10_000
_BLOCK_OPERATIONS = 2**29
"""The number of multiplications after which Ctrl-C can take effect: about 0.1 s."""


def performance_profile(scores: Scores, thresholds: ArrayLike) -> NDArray[np.float64]:
    """Returns (thresholds,): the proportion of runs that score above each threshold, averaged over the environments.

    Args:
        scores: The scores of each environment by name, (runs,) each, or an array (runs, environments).
        thresholds: (thresholds,) float.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    levels = arrays.sample("thresholds", thresholds)
    above = [np.mean(sample[:, np.newaxis] > levels, axis=0) for sample in as_samples("scores", scores)]
    profile: NDArray[np.float64] = np.mean(above, axis=0)
    return profile


def profile(
    scores: Scores,
    thresholds: ArrayLike,
    *,
    confidence: float = CONFIDENCE,
    resamples: int = AGGREGATE_RESAMPLES,
    seed: int = 0,
) -> list[Interval]:
    """Returns the performance profile with its stratified bootstrap interval at each threshold.

    The intervals hold for each threshold alone, not for the whole curve at once. If all or none of the runs score
    above a threshold, all resamples agree, and the interval has a width of zero.

    Args:
        scores: The scores of each environment by name, (runs,) each, or an array (runs, environments); at least two
            runs of each environment.
        thresholds: (thresholds,) float, at most 10,000.
        confidence: The coverage probability of each interval, between 0 and 1.
        resamples: The number of bootstrap resamples, at most a million.
        seed: Seeds the bootstrap.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    levels = arrays.sample("thresholds", thresholds)
    if len(levels) > MAX_THRESHOLDS:
        raise ValueError(f"thresholds must hold at most {MAX_THRESHOLDS:,} numbers, got {len(levels):,}")
    samples = as_samples("scores", scores, least=2)
    confidence, resamples = as_confidence(confidence), as_resamples(resamples)
    rng = np.random.default_rng(checks.integer("seed", seed, least=0))
    # The quantiles of a threshold need all of its resamples at once, so thresholds are processed in small batches to
    # bound the memory. The same resamples are drawn again for each batch.
    state = rng.bit_generator.state
    columns = max(1, BATCH_VALUES // max(resamples, *map(len, samples)))
    tails = [(1 - confidence) / 2, (1 + confidence) / 2]
    bounds = []
    for first in range(0, len(levels), columns):
        rng.bit_generator.state = state
        above = [(sample[:, np.newaxis] > levels[first : first + columns]).astype(np.float64) for sample in samples]
        bounds.append(np.quantile(_resampled(above, resamples, rng), tails, axis=0))
    low, high = np.concatenate(bounds, axis=1)
    estimates = performance_profile(scores, levels)
    return [
        Interval(*point, confidence, "stratified percentile")
        for point in zip(estimates.tolist(), low.tolist(), high.tolist(), strict=True)
    ]


def _resampled(above: list[NDArray[np.float64]], resamples: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Returns (resamples, thresholds): the profiles of resampled runs, drawn in blocks."""
    profiles = np.empty((resamples, above[0].shape[1]))
    block = max(1, _BLOCK_OPERATIONS // (max(map(len, above)) * max(above[0].shape[1], 512)))
    for first in range(0, resamples, block):
        count = min(block, resamples - first)
        # The number of times that each run is drawn; in total, the number of runs.
        drawn = (
            rng.multinomial(len(environment), np.full(len(environment), 1 / len(environment)), count) @ environment
            for environment in above
        )
        shares = (hits / len(environment) for hits, environment in zip(drawn, above, strict=True))
        profiles[first : first + count] = sum(shares) / len(above)
    return profiles
