"""Statistics of learning curves, which are arrays of returns, (runs, episodes)."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import arrays, checks
from qtab.stats.bootstrap import as_resamples, bootstrap
from qtab.stats.interval import Interval
from qtab.stats.intervals import CONFIDENCE, interquartile_mean, t_intervals

CURVE_RESAMPLES = 999
_STATISTICS: dict[str, Any] = {"mean": np.mean, "median": np.median, "iqm": interquartile_mean}


def area_under_curve(returns: ArrayLike) -> NDArray[np.float64]:
    """Returns (runs,): the area under each learning curve divided by its length, which is the mean return.

    Args:
        returns: (runs, episodes), such as ``runs.episode_returns``.

    Raises:
        TypeError: if the returns are not numbers.
        ValueError: for another shape, or returns that are not finite.
    """
    area: NDArray[np.float64] = arrays.curves("returns", returns).mean(axis=1)
    return area


def episodes_to_threshold(returns: ArrayLike, threshold: float, *, window: int = 100) -> NDArray[np.float64]:
    """Returns (runs,): the number of episodes after which the mean of the last ``window`` returns reaches a threshold.

    It is infinite for a run that never reaches the threshold: ``np.median`` then treats it as the slowest, and
    ``stats.rate(np.isfinite(episodes).sum(), len(episodes))`` is the proportion of runs that reach it.

    Args:
        returns: (runs, episodes), such as ``runs.episode_returns``.
        threshold: The mean return to reach.
        window: The number of episodes in the mean.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or a window longer than the runs.
    """
    curves = arrays.curves("returns", returns)
    threshold = checks.finite("threshold", threshold)
    window = checks.integer("window", window, least=1, most=curves.shape[1])
    episodes = np.empty(len(curves))
    for run, curve in enumerate(curves):
        reached = np.lib.stride_tricks.sliding_window_view(curve, window).mean(axis=1) >= threshold
        episodes[run] = np.argmax(reached) + window if reached.any() else np.inf
    return episodes


def curve(
    returns: ArrayLike,
    *,
    block: int = 100,
    statistic: str = "mean",
    confidence: float = CONFIDENCE,
    resamples: int = CURVE_RESAMPLES,
    seed: int = 0,
) -> list[Interval]:
    """Returns a statistic over the runs with its interval, for each whole block of episodes.

    The intervals are those of :func:`mean`, :func:`median` and :func:`iqm`: Student's t for the mean, else the
    bootstrap's. Each holds for its block alone, not for the whole curve at once.

    Args:
        returns: (runs, episodes), such as ``runs.episode_returns``; at least two runs.
        block: The number of episodes in a block. A run counts with its mean return in the block.
        statistic: ``"mean"``, ``"median"`` or ``"iqm"``.
        confidence: The coverage probability of the intervals, between 0 and 1.
        resamples: The number of bootstrap resamples, at most a million.
        seed: Seeds the bootstrap.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, a single run, which has no interval, or returns that are not finite.
    """
    curves = arrays.curves("returns", returns)
    if len(curves) < 2:
        raise ValueError("returns must hold at least 2 runs for an interval, got 1")
    block = checks.integer("block", block, least=1, most=curves.shape[1])
    function = _STATISTICS[checks.choice("statistic", statistic, _STATISTICS)]
    whole = curves.shape[1] // block * block
    means = curves[:, :whole].reshape(len(curves), -1, block).mean(axis=2)
    if statistic == "mean":
        as_resamples(resamples)
        checks.integer("seed", seed, least=0)
        return t_intervals(means, confidence)
    return [bootstrap([column], function, confidence, resamples, seed) for column in means.T]
