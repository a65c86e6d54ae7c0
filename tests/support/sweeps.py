"""A small sweep, and the comparison of two."""

from typing import Any

import numpy as np

CAR = "MountainCar-v0"
GRID: dict[str, Any] = {"learning_rate": [0.1, 0.2, 0.4], "epsilon": [0.3, 0.8]}
SMALL: dict[str, Any] = {"seeds": 5, "episodes": 40}


def assert_equal(one, other):
    assert list(one.columns) == list(other.columns)
    for name, column in one.columns.items():
        assert column.dtype == other.columns[name].dtype
        np.testing.assert_array_equal(column, other.columns[name], strict=True)
    assert list(one._curves) == list(other._curves)
