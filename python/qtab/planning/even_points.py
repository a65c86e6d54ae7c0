"""Points that cover a box evenly."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def even_points(low: ArrayLike, high: ArrayLike, count: int) -> NDArray[np.float64]:
    """Returns (count, components) points that cover a box evenly, by an additive recurrence.

    M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
    """
    lower, upper = np.array(low), np.array(high)
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (len(lower) + 1))
    steps = root ** -np.arange(1.0, len(lower) + 1)
    return np.asarray(lower + (upper - lower) * ((0.5 + np.arange(1, count + 1)[:, None] * steps) % 1.0))
