"""Summaries of runs: a few numbers for each run, and what they are compared with."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

FINAL_EPISODES = 100
"""The final return of a run is the mean of this many last episodes."""

SOLVED_EPISODES = 100
"""A task counts as solved once the mean return of this many consecutive episodes reaches its threshold."""

MAX_BLOCKS = 100
"""The maximum number of averages that remain legible in a terminal or a figure."""


def default_block(episodes: int) -> int:
    """Returns the default number of episodes to average over: the article's 100, or 1000 and so on in long runs."""
    block = 100
    while episodes > MAX_BLOCKS * block:
        block *= 10
    return block


def summarize(
    returns: NDArray[np.float64], lengths: NDArray[np.int64], terminated: NDArray[np.bool_]
) -> dict[str, NDArray[Any]]:
    """Returns columns of (runs,) numbers, from arrays of (runs, episodes).

    ``final_return`` is the mean of the last 100 returns (of all if there are fewer). ``mean_return`` is the mean of
    all returns: the area under the learning curve, scaled to a width of 1.
    """
    runs, episodes = returns.shape
    return {
        "episodes": np.full(runs, episodes),
        "steps": lengths.sum(axis=1),
        "mean_return": returns.mean(axis=1),
        "final_return": returns[:, -FINAL_EPISODES:].mean(axis=1),
        "best_return": returns.max(axis=1),
        "terminated_rate": terminated.mean(axis=1),
    }


def block_means(returns: NDArray[np.float64], block: int) -> NDArray[np.float64]:
    """Returns (runs, blocks): the average return of each whole block of episodes, run by run."""
    runs, episodes = returns.shape
    whole = episodes // block * block
    means: NDArray[np.float64] = returns[:, :whole].reshape(runs, whole // block, block).mean(axis=2)
    return means


def best_mean_returns(returns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (runs,): each run's highest mean return over 100 consecutive episodes; -inf for shorter runs."""
    (runs, episodes), window = returns.shape, SOLVED_EPISODES
    if episodes < window:
        return np.full(runs, -np.inf)
    sums = np.cumsum(np.pad(returns, ((0, 0), (1, 0))), axis=1)
    best: NDArray[np.float64] = np.max((sums[:, window:] - sums[:, :-window]) / window, axis=1)
    return best


class KnownOptimum(Protocol):
    """A result of :func:`qtab.optimum`, whose class is in a package that imports this one."""

    @property
    def expected_return(self) -> float:
        """The expected return of the best policy."""

    @property
    def label(self) -> str:
        """``"optimum"``, or ``"best known"`` if the result is not exact."""

    @property
    def exact(self) -> bool:
        """True if it is proven that no policy has a higher expected return."""

    @property
    def stationary(self) -> Any:
        """The best policy that ignores the number of steps taken; None if unknown."""

    @property
    def solver(self) -> Any:
        """The solver, which computes the expected return of other policies."""
