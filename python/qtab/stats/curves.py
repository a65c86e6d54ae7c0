"""Statistics of learning curves, which are arrays of returns, (runs, episodes)."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab.stats.intervals import CONFIDENCE, Interval, bootstrap, interquartile_mean

CURVE_RESAMPLES = 999
_STATISTICS: dict[str, Any] = {"mean": np.mean, "median": np.median, "iqm": interquartile_mean}


def _as_curves(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Returns the values of the argument ``name`` as a float64 array (runs, episodes); a single run may be (episodes,).

    Raises:
        ValueError: if they have another shape, or are empty.
    """
    array = np.atleast_2d(np.asarray(values, dtype=np.float64))
    if array.ndim != 2 or array.size == 0:
        raise ValueError(f"{name} must have the shape (runs, episodes), got {array.shape}")
    return array


def area_under_curve(returns: ArrayLike) -> NDArray[np.float64]:
    """Returns (runs,): the area under each learning curve divided by its length, which is the mean return.

    Args:
        returns: (runs, episodes), such as ``runs.episode_returns``.

    Raises:
        ValueError: for another shape.
    """
    area: NDArray[np.float64] = _as_curves("returns", returns).mean(axis=1)
    return area


def episodes_to_threshold(returns: ArrayLike, threshold: float, *, window: int = 100) -> NDArray[np.float64]:
    """Returns (runs,): the number of episodes after which the mean of the last ``window`` returns reaches a threshold.

    It is infinite for a run that never reaches the threshold, so that a median over the runs treats it as the slowest.

    Args:
        returns: (runs, episodes), such as ``runs.episode_returns``.
        threshold: The mean return to reach.
        window: The number of episodes that the mean is taken over.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or a window longer than the runs.
    """
    curves = _as_curves("returns", returns)
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
    """Returns a statistic over the runs with its bootstrap interval, for each whole block of episodes.

    Args:
        returns: (runs, episodes), such as ``runs.episode_returns``.
        block: The number of episodes in a block. A run enters with its mean return in the block.
        statistic: ``"mean"``, ``"median"`` or ``"iqm"``.
        confidence: The coverage probability of the intervals, in [0, 1].
        resamples: The number of bootstrap resamples.
        seed: Seeds the bootstrap.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    curves = _as_curves("returns", returns)
    block = checks.integer("block", block, least=1, most=curves.shape[1])
    function = _STATISTICS[checks.choice("statistic", statistic, _STATISTICS)]
    whole = curves.shape[1] // block * block
    means = curves[:, :whole].reshape(len(curves), -1, block).mean(axis=2)
    return [bootstrap(column, function, confidence, resamples, seed) for column in means.T]
