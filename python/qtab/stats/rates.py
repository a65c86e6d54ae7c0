"""Shares of runs."""

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from qtab._utils import checks
from qtab.stats.intervals import CONFIDENCE, Interval, sample


def rate(successes: int, count: int, *, confidence: float = CONFIDENCE) -> Interval:
    """Returns a share with its Wilson interval, which stays within [0, 1] and has a width at 0 and 1 too.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    count = checks.integer("count", count, least=1)
    successes = checks.integer("successes", successes, least=0, most=count)
    confidence = checks.real("confidence", confidence, 0, 1)
    found = stats.binomtest(successes, count).proportion_ci(confidence, method="wilson")
    return Interval(successes / count, float(found.low), float(found.high), confidence, "Wilson")


def solved_rate(returns: ArrayLike, threshold: float, *, confidence: float = CONFIDENCE) -> Interval:
    """Returns the share of returns, one a run, that are at or above a threshold, with its Wilson interval.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    solved = sample("returns", returns) >= checks.finite("threshold", threshold)
    return rate(int(np.count_nonzero(solved)), len(solved), confidence=confidence)
