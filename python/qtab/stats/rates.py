"""Proportions of runs with confidence intervals."""

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from qtab._utils import arrays, checks
from qtab.stats.bootstrap import as_confidence
from qtab.stats.interval import Interval
from qtab.stats.intervals import CONFIDENCE


def rate(successes: int, count: int, *, confidence: float = CONFIDENCE) -> Interval:
    """Returns a proportion with its Wilson interval, which lies within [0, 1] and has a positive width even at 0 and 1.

    Args:
        successes: The number of successes.
        count: The number of trials.
        confidence: The coverage probability of the interval, between 0 and 1.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    count = checks.count("count", count, least=1)
    successes = checks.integer("successes", successes, least=0, most=count)
    confidence = as_confidence(confidence)
    interval = stats.binomtest(successes, count).proportion_ci(confidence, method="wilson")
    return Interval(successes / count, float(interval.low), float(interval.high), confidence, "Wilson")


def solved_rate(returns: ArrayLike, threshold: float, *, confidence: float = CONFIDENCE) -> Interval:
    """Returns the proportion of runs whose return is at least a threshold, with its Wilson interval.

    Args:
        returns: (runs,): one return per run.
        threshold: The return from which a run counts as solved.
        confidence: The coverage probability of the interval, between 0 and 1.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    solved = arrays.sample("returns", returns) >= checks.finite("threshold", threshold)
    return rate(int(np.count_nonzero(solved)), len(solved), confidence=confidence)
