"""Equal to the last bit: types, dtypes, shapes and bytes, in containers too."""

from typing import Any

import numpy as np

ARRAYS = (np.ndarray, np.generic)


def bitwise(value: Any) -> Any:
    """A value in a form whose ``==`` compares to the last bit; NaN equals itself, and -0.0 is not 0.0."""
    if isinstance(value, ARRAYS):
        return type(value), value.dtype, value.shape, value.tobytes()
    if isinstance(value, float):
        return float, value.hex()
    if isinstance(value, tuple):
        return tuple(map(bitwise, value))
    if isinstance(value, list):
        return [bitwise(item) for item in value]
    if isinstance(value, dict):
        return {name: bitwise(item) for name, item in value.items()}
    return type(value), value


def identical(one: Any, other: Any) -> bool:
    """Whether two values have the same bits: as ``bitwise(one) == bitwise(other)``, and faster."""
    if one is other:
        return True
    kind = type(one)
    if kind is not type(other):
        return False
    if kind is float:
        return bool(one.hex() == other.hex())
    if kind is tuple or kind is list:
        if len(one) != len(other):
            return False
        for item, counterpart in zip(one, other, strict=True):
            if item is not counterpart and not identical(item, counterpart):
                return False
        return True
    if kind is dict:
        return one.keys() == other.keys() and all(identical(item, other[name]) for name, item in one.items())
    if isinstance(one, ARRAYS):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    return bool(one == other)


def assert_identical(one: Any, other: Any) -> None:
    assert identical(one, other), f"{one!r} is not {other!r}"
