"""Estimates from a sample with confidence and tolerance intervals."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from qtab._utils import checks

CONFIDENCE = 0.95
RESAMPLES = 9999
TRIM_FRACTION = 0.25
"""The fraction of the values that the interquartile mean leaves out at each end."""
_BATCH_VALUES = 2**22
"""The number of resampled values that a bootstrap holds in memory at a time."""


@dataclass(frozen=True)
class Interval:
    """An estimate and its interval."""

    estimate: float
    low: float
    high: float
    confidence: float
    """The coverage probability: how often such an interval contains the true value."""
    method: str
    """``"BCa"``, ``"percentile"`` (where BCa has no finite bounds), ``"stratified percentile"``, ``"constant"`` (all
    values equal), ``"Wilson"`` or ``"order statistics"``."""

    def __str__(self) -> str:
        return f"{self.estimate:.6g} [{self.low:.6g}, {self.high:.6g}]"


def as_sample(name: str, values: ArrayLike, least: int = 1) -> NDArray[np.float64]:
    """Returns the values of the argument ``name`` as a one-dimensional float64 array.

    Raises:
        TypeError: if they are not numbers.
        ValueError: if they are not one-dimensional, fewer than ``least``, or NaN.
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must hold numbers, got {values!r}") from None
    if array.ndim != 1 or len(array) < least:
        raise ValueError(f"{name} must be a one-dimensional array of at least {least} numbers, got shape {array.shape}")
    if np.isnan(array).any():
        raise ValueError(f"{name} must not contain nan")
    return array


def mean(values: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0) -> Interval:
    """Returns the mean with its bootstrap interval.

    Args:
        values: (runs,): one number per run, such as ``runs.final_returns()``.
        confidence: The coverage probability of the interval, in [0, 1].
        resamples: The number of bootstrap resamples.
        seed: Seeds the bootstrap.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    return bootstrap(as_sample("values", values), np.mean, confidence, resamples, seed)


def median(values: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0) -> Interval:
    """Returns the median with its bootstrap interval; see :func:`mean` for the arguments."""
    return bootstrap(as_sample("values", values), np.median, confidence, resamples, seed)


def iqm(values: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0) -> Interval:
    """Returns the interquartile mean, which is the mean of the middle half, with its bootstrap interval.

    See :func:`mean` for the arguments. Source: Agarwal et al., "Deep reinforcement learning at the edge of the
    statistical precipice" (2021).
    """
    return bootstrap(as_sample("values", values), interquartile_mean, confidence, resamples, seed)


def interquartile_mean(values: NDArray[np.float64], axis: int | None = None) -> Any:
    """Returns the mean along an axis without the lowest and the highest quarter of the values."""
    return stats.trim_mean(values, TRIM_FRACTION, axis=axis)


def bootstrap(
    values: NDArray[np.float64], statistic: Callable[..., Any], confidence: float, resamples: int, seed: int
) -> Interval:
    """Returns a statistic with its bias-corrected and accelerated (BCa) bootstrap interval (Efron, 1987).

    If all values are equal, both bounds are that value. If the BCa bounds are not finite, the bounds are those of the
    percentile method, which ``method`` records.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    confidence = checks.real("confidence", confidence, 0, 1)
    resamples = checks.integer("resamples", resamples, least=1)
    seed = checks.integer("seed", seed, least=0)
    estimate = float(statistic(values))
    if np.ptp(values) == 0 or len(values) == 1:
        return Interval(estimate, estimate, estimate, confidence, "constant")
    for method in ("BCa", "percentile"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # SciPy warns of bounds that are not finite, which are checked below
            interval = stats.bootstrap(
                (values,),
                statistic,
                n_resamples=resamples,
                batch=max(1, _BATCH_VALUES // len(values)),
                confidence_level=confidence,
                method=method,
                rng=np.random.default_rng(seed),
            ).confidence_interval
        if np.isfinite([interval.low, interval.high]).all():
            break
    return Interval(estimate, float(interval.low), float(interval.high), confidence, method)


def tolerance_interval(values: ArrayLike, *, coverage: float = 0.9, confidence: float = CONFIDENCE) -> Interval:
    """Returns bounds that, with the given confidence, contain at least the fraction ``coverage`` of all runs.

    The interval makes no assumption on the distribution. Its bounds are two values of the sample, whose ranks follow
    from the beta distribution of the probability between two order statistics (Wilks, 1941). ``estimate`` is the
    median of the sample.

    Args:
        values: (runs,): one number per run.
        coverage: The fraction of runs that the interval is to contain, in [0, 1].
        confidence: The probability that it does, in [0, 1].

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or a sample that is too small; the message says how many values are
            needed.
    """
    ordered = np.sort(as_sample("values", values))
    coverage = checks.real("coverage", coverage, 0, 1)
    confidence = checks.real("confidence", confidence, 0, 1)
    count = len(ordered)
    # Two order statistics whose ranks differ by w enclose a probability with the distribution Beta(w, count - w + 1).
    rank_differences = np.arange(1, count)
    is_enough = stats.beta.sf(coverage, rank_differences, count - rank_differences + 1) >= confidence
    if not is_enough.any():
        raise ValueError(
            f"values must hold at least {_sample_size(coverage, confidence)} numbers for a coverage of {coverage:g} "
            f"with confidence {confidence:g}, got {count}"
        )
    width = int(rank_differences[np.argmax(is_enough)])
    first = (count - width - 1) // 2
    return Interval(
        float(np.median(ordered)), float(ordered[first]), float(ordered[first + width]), confidence, "order statistics"
    )


def _sample_size(coverage: float, confidence: float) -> str:
    """Returns the smallest sample size that has such an interval."""
    counts = np.arange(2, 100_000)
    is_enough = stats.beta.sf(coverage, counts - 1, 2) >= confidence
    return str(counts[np.argmax(is_enough)]) if is_enough.any() else "more than 100,000"
