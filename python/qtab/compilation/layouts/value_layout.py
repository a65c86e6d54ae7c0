"""The layout of a value in memory: numbers, arrays of fixed shapes, and tuples of them, as C structs."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Number:
    """A number or a boolean."""

    dtype: np.dtype[Any]


@dataclass(frozen=True)
class Array:
    """An array of numbers, in C order."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]


@dataclass(frozen=True)
class Tuple:
    """A tuple, or a named tuple."""

    items: tuple["Layout", ...]
    cls: type | None = None
    """The class of a named tuple; None for a tuple."""


Layout: TypeAlias = Number | Array | Tuple


def dtype_of(layout: Layout) -> np.dtype[Any]:
    """Returns the layout as a NumPy dtype, with the alignment of C."""
    if isinstance(layout, Number):
        return layout.dtype
    if isinstance(layout, Array):
        return np.dtype((layout.dtype, layout.shape))
    return np.dtype([(f"f{index}", dtype_of(item)) for index, item in enumerate(layout.items)], align=True)


def offsets(layout: Tuple) -> list[int]:
    """Returns the offset of each item of a tuple, in bytes."""
    fields: Any = dtype_of(layout).fields or {}
    return [int(fields[f"f{index}"][1]) for index in range(len(layout.items))]


def leaves(layout: Layout, name: str) -> Iterator[tuple[str, int, Number | Array]]:
    """Yields the numbers and arrays of a layout with their names, such as ``"state[0]"``, and offsets in bytes."""
    if not isinstance(layout, Tuple):
        yield name, 0, layout
        return
    for index, (item, offset) in enumerate(zip(layout.items, offsets(layout), strict=True)):
        for found, inner, leaf in leaves(item, f"{name}[{index}]"):
            yield found, offset + inner, leaf


def encode(layout: Layout, value: Any) -> NDArray[np.uint8]:
    """Returns a value as bytes.

    Raises:
        TypeError: if the value holds other values than numbers.
        ValueError: if it has another structure than the layout.
    """
    memory = np.zeros(dtype_of(layout).itemsize, np.uint8)
    _write(layout, value, memory)
    return memory


def decode(layout: Layout, memory: NDArray[np.uint8]) -> Any:
    """Returns the value in memory: ints, floats, booleans, and copies of arrays, in tuples."""
    if isinstance(layout, Number):
        return memory[: layout.dtype.itemsize].view(layout.dtype)[0].item()
    if isinstance(layout, Array):
        size = dtype_of(layout).itemsize
        return memory[:size].view(layout.dtype).reshape(layout.shape).copy()
    items = [decode(item, memory[offset:]) for item, offset in zip(layout.items, offsets(layout), strict=True)]
    return tuple(items) if layout.cls is None else layout.cls(*items)


def _write(layout: Layout, value: Any, memory: NDArray[np.uint8]) -> None:
    if isinstance(layout, Tuple):
        if not isinstance(value, tuple | list) or len(value) != len(layout.items):
            raise ValueError(f"a tuple of {len(layout.items)} items is needed, got {value!r}")
        for item, offset, part in zip(layout.items, offsets(layout), value, strict=True):
            _write(item, part, memory[offset:])
        return
    array = np.asarray(value)
    shape = layout.shape if isinstance(layout, Array) else ()
    if array.dtype.kind not in "biuf":
        raise TypeError(f"numbers are needed, got {value!r}")
    if array.shape != shape:
        raise ValueError(f"an array of shape {shape} is needed, got {value!r}")
    memory[: dtype_of(layout).itemsize] = np.ascontiguousarray(array.astype(layout.dtype)).reshape(-1).view(np.uint8)


def layout_of(value: Any) -> Layout:
    """Returns the layout of a value. Lists have the layout of tuples.

    Raises:
        TypeError: if it contains other values than numbers, tuples and arrays of numbers; the message names the type.
        OverflowError: if an integer does not fit 64 bits.
    """
    if isinstance(value, bool | np.bool_):
        return Number(np.dtype(np.bool_))
    if isinstance(value, int):
        if not -(2**63) <= value < 2**63:
            raise OverflowError(f"the integer {value} does not fit 64 bits")
        return Number(np.dtype(np.int64))
    if isinstance(value, float):
        return Number(np.dtype(np.float64))
    if isinstance(value, np.ndarray | np.number) and value.dtype.kind in "biuf" and value.dtype.itemsize <= 8:
        dtype = value.dtype.newbyteorder("=")
        return Array(dtype, value.shape) if isinstance(value, np.ndarray) else Number(dtype)
    if isinstance(value, tuple | list):
        named = type(value) if hasattr(value, "_fields") else None
        return Tuple(tuple(map(layout_of, value)), named)
    raise TypeError(type(value).__name__)


def to_json(layout: Layout) -> Any:
    """Returns a layout as values of JSON, without the classes of named tuples."""
    if isinstance(layout, Number):
        return str(layout.dtype)
    if isinstance(layout, Array):
        return {"dtype": str(layout.dtype), "shape": list(layout.shape)}
    return [to_json(item) for item in layout.items]


def from_json(stored: Any) -> Layout:
    """Returns a layout that ``to_json`` has returned; named tuples have become tuples."""
    if isinstance(stored, str):
        return Number(np.dtype(stored))
    if isinstance(stored, dict):
        return Array(np.dtype(stored["dtype"]), tuple(stored["shape"]))
    return Tuple(tuple(map(from_json, stored)))
