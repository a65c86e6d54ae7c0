"""Functions for compiled code that write observations and action masks, and report whether they are valid."""

from collections.abc import Iterator
from typing import Any

import numba
import numpy as np
from numba.core import types

from qtab.compilation.c_functions.addresses import pointer
from qtab.compilation.checks.checked_operations import OPTIONS
from qtab.compilation.layouts.observation_layout import ObservationLayout, ObservationPart
from qtab.compilation.not_compilable import NotCompilable

MOST_UNROLLED = 64
"""Tuples of at most this many numbers are written one by one."""


def observation_writer(layout: ObservationLayout, of: Any) -> Any:
    """Returns a function of an address and an observation, for compiled code.

    It writes the numbers as Python's conversion to the space does, and returns whether the observation has the shape of
    the space and lies in it.

    Args:
        layout: The layout.
        of: The type of the observations in compiled code.

    Raises:
        NotCompilable: if an observation of this type cannot be one of the space.
    """
    lines = ["def write(address, value):", "    out = carray(pointer(address), SIZE, DTYPE)"]
    first = 0
    for part in layout.parts:
        expression, part_type = "value", of
        for index in part.path:
            if not isinstance(part_type, types.BaseTuple) or index >= len(part_type):
                raise NotCompilable(f"observe returns {of}, not a tuple with the parts of the observation space")
            expression, part_type = f"{expression}[{index}]", part_type.types[index]
        lines += [f"    {line}" for line in _part_lines(part, first, expression, part_type)]
        first += len(part.low)
    scope = {"SIZE": (layout.size,), "DTYPE": layout.dtype.type, "LOW": layout.low, "HIGH": layout.high}
    return _made([*lines, "    return True"], "write", scope)


def mask_writer(num_actions: int, of: Any) -> Any:
    """Returns a function of an address, a mask, and whether the state is terminal, for compiled code.

    It returns whether the mask is valid: 0 or 1 for each action, and at least one 1 unless the state is terminal.

    Args:
        num_actions: The number of actions.
        of: The type of the masks in compiled code.

    Raises:
        NotCompilable: if an object of this type cannot be a mask.
    """
    part = ObservationPart((), (num_actions,), "int64", np.zeros(num_actions), np.ones(num_actions))
    lines = ["def write_mask(address, value, terminated):", "    out = carray(pointer(address), SIZE, DTYPE)"]
    lines += [f"    {line}" for line in _part_lines(part, 0, "value", of)]
    # A loop, which compiles faster than out.any().
    lines += [
        "    for i in range(len(out)):",
        "        if out[i] != 0:",
        "            return True",
        "    return terminated",
    ]
    scope = {"SIZE": (num_actions,), "DTYPE": np.uint8, "LOW": part.low, "HIGH": part.high}
    return _made(lines, "write_mask", scope)


def _made(lines: list[str], name: str, scope: dict[str, Any]) -> Any:
    scope |= {"np": np, "carray": numba.carray, "pointer": pointer}
    exec("\n".join(lines), scope)  # noqa: S102 - code of this module
    return numba.njit(**OPTIONS)(scope[name])


def _part_lines(part: ObservationPart, first: int, expression: str, of: Any) -> Iterator[str]:
    """Yields the lines that write the numbers of a part, from ``out[first]`` on."""
    shape = part.shape
    if isinstance(of, types.Array) and of.ndim == len(shape) and shape:
        _check_kind(part, of.dtype)
        yield f"if {expression}.shape != {shape!r}:"
        yield "    return False"
        names = [f"i{axis}" for axis in range(len(shape))]
        yield f"position = {first}"
        for depth, (name, size) in enumerate(zip(names, shape, strict=True)):
            yield "    " * depth + f"for {name} in range({size}):"
        inner = "    " * len(shape)
        yield from (inner + line for line in _number(part, "position", f"{expression}[{', '.join(names)}]"))
        yield inner + "position += 1"
    elif isinstance(of, types.List | types.UniTuple) and len(shape) == 1 and _is_number(of.dtype):
        _check_kind(part, of.dtype)
        yield f"if len({expression}) != {shape[0]}:"
        yield "    return False"
        if isinstance(of, types.UniTuple) and shape[0] <= MOST_UNROLLED and len(of) == shape[0]:
            for index in range(shape[0]):
                yield from _number(part, str(first + index), f"{expression}[{index}]")
        else:
            yield f"for i0 in range({shape[0]}):"
            yield from ("    " + line for line in _number(part, f"{first} + i0", f"{expression}[i0]"))
    elif isinstance(of, types.BaseTuple) and shape:
        if len(of) != shape[0]:
            raise NotCompilable(f"observe returns {of} for a space of shape {shape}")
        step = len(part.low) // shape[0]
        for index in range(shape[0]):
            inner_part = ObservationPart((), shape[1:], part.kind, part.low[:step], part.high[:step])
            yield from _part_lines(inner_part, first + index * step, f"{expression}[{index}]", of.types[index])
    elif _is_number(of) and shape in ((), (1,)):
        _check_kind(part, of)
        yield from _number(part, str(first), expression)
    else:
        raise NotCompilable(f"observe returns {of} for a space of shape {shape}")


def _number(part: ObservationPart, place: str, expression: str) -> Iterator[str]:
    # Through float64, as NumPy converts Python's numbers to float32.
    converted = f"np.float32(np.float64({expression}))" if part.kind == "float32" else f"np.{part.kind}({expression})"
    yield f"number = {converted}"
    yield f"if not (LOW[{place}] <= number <= HIGH[{place}]):"
    yield "    return False"
    yield f"out[{place}] = number"


def _is_number(of: Any) -> bool:
    return isinstance(types.unliteral(of), types.Integer | types.Float | types.Boolean)


def _check_kind(part: ObservationPart, of: Any) -> None:
    of = types.unliteral(of)
    if part.kind == "int64" and not isinstance(of, types.Integer | types.Boolean):
        raise NotCompilable(f"observe returns {of} where the observation space has integers")
    if of in (types.uint64,):
        raise NotCompilable("observe returns unsigned integers of 64 bits")
