"""A run in a few numbers."""

import numpy as np
from numpy.typing import NDArray

FINAL_EPISODES = 100
"""How many of the last episodes the final return is the mean of."""


def summarize(
    returns: NDArray[np.float64], lengths: NDArray[np.int64], terminated: NDArray[np.bool_]
) -> dict[str, float | int]:
    """Returns what a run of (episodes,) comes to.

    ``final_return`` is the mean of the last 100 returns (of all where there are fewer), ``mean_return`` that of all:
    the area under the learning curve, an episode's width being one over their number.
    """
    return {
        "episodes": len(returns),
        "steps": int(lengths.sum()),
        "mean_return": float(returns.mean()),
        "final_return": float(returns[-FINAL_EPISODES:].mean()),
        "best_return": float(returns.max()),
        "terminated_rate": float(terminated.mean()),
    }
