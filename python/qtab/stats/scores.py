"""Scores on several environments, as arguments of functions."""

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import arrays

Scores: TypeAlias = Mapping[str, ArrayLike] | ArrayLike
"""The scores of each environment by name, (runs,) each, or an array (runs, environments)."""


def as_samples(name: str, scores: Scores, least: int = 1) -> list[NDArray[np.float64]]:
    """Returns the scores of each environment, (runs,) each.

    Args:
        name: The name of the argument.
        scores: Its value.
        least: The smallest number of runs of each environment; 2 for an interval.

    Raises:
        TypeError: if the scores are not numbers.
        ValueError: if they have another shape, are not finite, or there are too few runs or no environment.
    """
    purpose = " for an interval" if least > 1 else ""
    if isinstance(scores, Mapping):
        samples = [
            arrays.sample(f"{name}[{environment!r}]", values, least, purpose) for environment, values in scores.items()
        ]
    else:
        array = arrays.numbers(name, scores)
        if array.ndim != 2:
            raise ValueError(f"{name} must have the shape (runs, environments), got {array.shape}")
        samples = [arrays.sample(name, column, least, purpose) for column in array.T]
    if not samples:
        raise ValueError(f"{name} must hold at least one environment, got none")
    return samples
