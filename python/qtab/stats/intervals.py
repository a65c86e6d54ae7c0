"""Estimates from a sample, each with an interval that says how far it may be trusted."""

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
TRIMMED = 0.25
"""What the interquartile mean leaves out at either end."""
_BATCH_VALUES = 2**22
"""A bootstrap holds about so many numbers at a time."""


@dataclass(frozen=True)
class Interval:
    """An estimate and its interval."""

    estimate: float
    low: float
    high: float
    confidence: float
    """How often such an interval holds what it estimates."""
    method: str
    """How it was found: ``"BCa"``, ``"percentile"`` (where BCa gave no finite bounds), ``"constant"``, …"""

    def __str__(self) -> str:
        """The estimate with its bounds."""
        return f"{self.estimate:.6g} [{self.low:.6g}, {self.high:.6g}]"


def sample(name: str, values: ArrayLike, least: int = 1) -> NDArray[np.float64]:
    """Returns a sample as an array.

    Raises:
        TypeError: if it holds no numbers.
        ValueError: if it is not one row of at least ``least`` numbers without NaN.
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must hold numbers, got {values!r}") from None
    if array.ndim != 1 or len(array) < least:
        raise ValueError(f"{name} must be one row of at least {least} numbers, got the shape {array.shape}")
    if np.isnan(array).any():
        raise ValueError(f"{name} must not hold nan")
    return array


def mean(values: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0) -> Interval:
    """Returns the mean with its bootstrap interval."""
    return bootstrap(sample("values", values), np.mean, confidence, resamples, seed)


def median(values: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0) -> Interval:
    """Returns the median with its bootstrap interval."""
    return bootstrap(sample("values", values), np.median, confidence, resamples, seed)


def iqm(values: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0) -> Interval:
    """Returns the interquartile mean, the mean of the middle half, with its bootstrap interval.

    Source: Agarwal et al., "Deep reinforcement learning at the edge of the statistical precipice" (2021).
    """
    return bootstrap(sample("values", values), interquartile_mean, confidence, resamples, seed)


def interquartile_mean(values: NDArray[np.float64], axis: int | None = None) -> Any:
    """Returns the mean without the lowest and the highest quarter."""
    return stats.trim_mean(values, TRIMMED, axis=axis)


def bootstrap(
    values: NDArray[np.float64], statistic: Callable[..., Any], confidence: float, resamples: int, seed: int
) -> Interval:
    """Returns a statistic with its bias-corrected and accelerated bootstrap interval (Efron, 1987).

    A sample of one value throughout, or of one number, has the interval of that value. Where the correction is not
    finite, the interval is the percentile one, and says so.

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
            warnings.simplefilter("ignore")  # the bounds are looked at instead
            found = stats.bootstrap(
                (values,),
                statistic,
                n_resamples=resamples,
                batch=max(1, _BATCH_VALUES // len(values)),
                confidence_level=confidence,
                method=method,
                rng=np.random.default_rng(seed),
            ).confidence_interval
        if np.isfinite([found.low, found.high]).all():
            break
    return Interval(estimate, float(found.low), float(found.high), confidence, method)


def tolerance_interval(values: ArrayLike, *, coverage: float = 0.9, confidence: float = CONFIDENCE) -> Interval:
    """Returns bounds between which, with the given confidence, at least ``coverage`` of all runs lie.

    No distribution is assumed: the bounds are two values of the sample, the ranks of which follow from the beta
    distribution of what lies between them (Wilks, 1941). ``estimate`` is the sample's median.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or a sample too small; it says how many values it takes.
    """
    ordered = np.sort(sample("values", values))
    coverage = checks.real("coverage", coverage, 0, 1)
    confidence = checks.real("confidence", confidence, 0, 1)
    count = len(ordered)
    between = np.arange(1, count)
    enough = stats.beta.sf(coverage, between, count - between + 1) >= confidence
    if not enough.any():
        raise ValueError(
            f"values must hold at least {_needed(coverage, confidence)} numbers for a coverage of {coverage:g} with "
            f"confidence {confidence:g}, got {count}"
        )
    width = int(between[np.argmax(enough)])
    first = (count - width - 1) // 2
    return Interval(
        float(np.median(ordered)), float(ordered[first]), float(ordered[first + width]), confidence, "order statistics"
    )


def _needed(coverage: float, confidence: float) -> str:
    counts = np.arange(2, 100_000)
    enough = stats.beta.sf(coverage, counts - 1, 2) >= confidence
    return str(counts[np.argmax(enough)]) if enough.any() else "more than 100,000"
