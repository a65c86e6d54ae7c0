"""Bootstrap intervals, computed in batches of bounded memory; Ctrl-C takes effect between two batches."""

import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from qtab._utils import arrays, checks
from qtab.stats.interval import Interval

MAX_RESAMPLES = 1_000_000
"""The maximum number of resamples: more would not change the first three digits of a bound."""
BATCH_VALUES = 2**22
"""The number of resampled values to hold in memory at a time."""


def as_sample(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Returns the values of an argument as a float64 array of at least two numbers, which an interval needs.

    Raises:
        TypeError: if they are not numbers.
        ValueError: if they are not one-dimensional, fewer than two, or not finite.
    """
    return arrays.sample(name, values, least=2, purpose=" for an interval")


def as_confidence(value: Any) -> float:
    """Returns the value of the argument ``confidence`` as a float.

    Raises:
        TypeError: if it is not a number.
        ValueError: if it does not lie between 0 and 1, both excluded.
    """
    confidence = checks.real("confidence", value, 0, 1)
    if confidence in (0, 1):
        raise ValueError(f"confidence must be greater than 0 and less than 1, got {value!r}")
    return confidence


def as_resamples(value: Any) -> int:
    """Returns the value of the argument ``resamples`` as an integer.

    Raises:
        TypeError: if it is not an integer.
        ValueError: if it is less than 1 or more than a million.
    """
    return checks.integer("resamples", value, least=1, most=MAX_RESAMPLES)


def bootstrap(
    samples: Sequence[NDArray[np.float64]],
    statistic: Callable[..., Any],
    confidence: float,
    resamples: int,
    seed: int,
    *,
    stratified: bool = False,
) -> Interval:
    """Returns a statistic with its bias-corrected and accelerated (BCa) bootstrap interval (Efron, 1987).

    If all values are equal, both bounds are that value. If the BCa bounds are not finite, the bounds are those of the
    percentile method, which ``method`` records.

    Args:
        samples: (runs,) each: at least two numbers. Each sample is resampled separately.
        statistic: Maps an array and an ``axis`` to the statistic along that axis; if stratified, maps the samples to a
            number.
        confidence: The coverage probability of the interval, between 0 and 1.
        resamples: The number of resamples.
        seed: Seeds the resampling.
        stratified: Whether the interval is the percentile interval of a statistic of several samples.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    confidence, resamples = as_confidence(confidence), as_resamples(resamples)
    seed = checks.integer("seed", seed, least=0)
    estimate = float(statistic(*samples))
    if all(np.ptp(sample) == 0 for sample in samples):
        return Interval(estimate, estimate, estimate, confidence, "constant")
    for method in ("stratified percentile",) if stratified else ("BCa", "percentile"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # SciPy warns of bounds that are not finite, which are checked below
            interval = stats.bootstrap(
                samples,
                statistic,
                vectorized=not stratified,
                n_resamples=resamples,
                batch=max(1, BATCH_VALUES // sum(map(len, samples))),
                confidence_level=confidence,
                method=method.removeprefix("stratified "),
                rng=np.random.default_rng(seed),
            ).confidence_interval
        if np.isfinite([interval.low, interval.high]).all():
            break
    return Interval(estimate, float(interval.low), float(interval.high), confidence, method)
