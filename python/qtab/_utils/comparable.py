"""A form in which equal settings are equal."""

from collections.abc import Mapping
from typing import Any

import numpy as np


def comparable(value: Any) -> Any:
    """Returns a form in which equal values of a setting are equal: JSON, the format of saved runs, has no tuples."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Mapping):
        return {name: comparable(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return tuple(map(comparable, value))
    return value
