"""Learning curves, (runs, episodes), in numbers."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab.stats.intervals import CONFIDENCE, Interval, bootstrap, interquartile_mean

CURVE_RESAMPLES = 999
_STATISTICS: dict[str, Any] = {"mean": np.mean, "median": np.median, "iqm": interquartile_mean}


def table(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Returns (runs, episodes) as an array; one run may come as (episodes,).

    Raises:
        ValueError: if it has another shape, or is empty.
    """
    array = np.atleast_2d(np.asarray(values, dtype=np.float64))
    if array.ndim != 2 or array.size == 0:
        raise ValueError(f"{name} must have the shape (runs, episodes), got {array.shape}")
    return array


def area_under_curve(returns: ArrayLike) -> NDArray[np.float64]:
    """Returns (runs,): the area under each learning curve over a span of one, which is its mean return.

    Raises:
        ValueError: if ``returns`` has not the shape (runs, episodes).
    """
    area: NDArray[np.float64] = table("returns", returns).mean(axis=1)
    return area


def episodes_to_threshold(returns: ArrayLike, threshold: float, *, window: int = 100) -> NDArray[np.float64]:
    """Returns (runs,): after how many episodes the mean of the last ``window`` returns first reaches a threshold.

    It is infinite for a run that never does: sorted behind all others, as it should be, in a median.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or a window longer than the runs.
    """
    curves = table("returns", returns)
    threshold = checks.finite("threshold", threshold)
    window = checks.integer("window", window, least=1, most=curves.shape[1])
    found = np.empty(len(curves))
    for run, curve in enumerate(curves):
        reached = np.lib.stride_tricks.sliding_window_view(curve, window).mean(axis=1) >= threshold
        found[run] = np.argmax(reached) + window if reached.any() else np.inf
    return found


def curve(
    returns: ArrayLike,
    *,
    block: int = 100,
    statistic: str = "mean",
    confidence: float = CONFIDENCE,
    resamples: int = CURVE_RESAMPLES,
    seed: int = 0,
) -> list[Interval]:
    """Returns, for each whole block of episodes, a statistic over the runs with its bootstrap interval.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    curves = table("returns", returns)
    block = checks.integer("block", block, least=1, most=curves.shape[1])
    function = _STATISTICS[checks.choice("statistic", statistic, _STATISTICS)]
    whole = curves.shape[1] // block * block
    means = curves[:, :whole].reshape(len(curves), -1, block).mean(axis=2)
    return [bootstrap(column, function, confidence, resamples, seed) for column in means.T]
