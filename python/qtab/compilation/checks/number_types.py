"""The types of numbers in users' functions: those that compiled code computes with as Python does, and others."""

from typing import Any

import numpy as np
from numba.core import types

NUMBERS = (types.Integer, types.Float, types.Boolean)

CONVERT = "convert the numbers with np.int64(...) or np.float64(...)"
"""The advice where numbers of several types meet."""


def leaf(of: Any) -> Any:
    """Returns the type of a number, or of the numbers in an array."""
    of = types.unliteral(of)
    return of.dtype if isinstance(of, types.Array) else of


def is_int64(of: Any) -> bool:
    """Returns whether a type is int64, perhaps of a constant."""
    return bool(types.unliteral(of) == types.int64)


def is_narrow(of: Any) -> bool:
    """Returns whether a type is that of integers other than int64."""
    return isinstance(of, types.Integer) and (of.bitwidth < 64 or not of.signed)


def wide_instead(of: Any) -> str:
    """Returns what to write instead of a number of fewer than 64 bits."""
    return f"write {'np.float64' if of == types.float32 else 'np.int64'}(...)"


def mixed(kinds: list[Any]) -> str:
    """Returns why the type of a result can differ from NumPy's; an empty text if it does not."""
    narrow = next((kind for kind in kinds if is_narrow(kind)), None)
    if narrow is not None:
        return f"arithmetic of {narrow}"
    if any(kind == types.float32 for kind in kinds) and any(kind != types.float32 for kind in kinds):
        return "arithmetic of float32 and wider numbers"
    return ""


def of_integers(of: Any) -> bool:
    """Returns whether a sum of an array or a sequence is one of int64 or booleans."""
    if isinstance(of, types.BaseTuple):
        return all(kind == types.int64 or isinstance(kind, types.Boolean) for kind in map(types.unliteral, of.types))
    kind = types.unliteral(getattr(of, "dtype", of))
    return kind == types.int64 or isinstance(kind, types.Boolean)


def holds(of: Any, value: Any) -> bool:
    """Returns whether a type of numbers holds a constant exactly, so that comparisons with it are exact."""
    if not isinstance(value, int | float):
        return False
    if of == types.float32:
        return float(np.float32(value)) == value
    return bool(of == types.uint64) and isinstance(value, int) and 0 <= value < 2**63


def joins_boolean(given: Any, wanted: Any) -> bool:
    """Returns whether a boolean of a type becomes a number in another one. Those of NumPy add as no number does."""
    given, wanted = types.unliteral(given), types.unliteral(wanted)
    if isinstance(given, types.BaseTuple) and isinstance(wanted, types.BaseTuple) and len(given) == len(wanted):
        return any(joins_boolean(*pair) for pair in zip(given, wanted, strict=True))
    return isinstance(given, types.Boolean) and isinstance(wanted, types.Integer | types.Float)
