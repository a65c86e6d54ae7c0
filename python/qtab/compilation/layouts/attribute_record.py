"""The state of an ordinary Gymnasium class: its attributes as bytes, followed by its observation."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.layouts.value_layout import Array, Layout, Number, Tuple

OBSERVATION = "observation of the state"
"""The field of the observation, whose name no attribute can have."""


def with_observation(record: np.dtype[Any], observation: ObservationLayout) -> np.dtype[Any]:
    """Returns the record of the attributes with the observation behind them, which can then be read from a state."""
    names = record.names or ()
    kept = [(name, record[name].base, record[name].shape) for name in names]
    return np.dtype([*kept, (OBSERVATION, observation.dtype, (observation.size,))], align=True)


def layout_of_record(record: np.dtype[Any]) -> Layout:
    """Returns the layout of a record."""
    items: list[Layout] = []
    for name in record.names or ():
        field = record[name]
        items.append(Array(field.base, field.shape) if field.shape else Number(field))
    return Tuple(tuple(items))


def state_bytes(record: np.dtype[Any], env: Any, observation: NDArray[Any]) -> NDArray[np.uint8]:
    """Returns the state of an environment as bytes.

    Args:
        record: The record with the observation.
        env: The environment.
        observation: The numbers of its observation.
    """
    state = np.zeros(1, record)
    for name in record.names or ():
        if name == OBSERVATION:
            state[name] = observation
        elif name != "unused":
            value = _attribute(env, name)
            try:
                state[name] = value
            except OverflowError:
                reason = f"self.{name} is {value}, which does not fit 64 bits"
                raise OverflowError(f"{reason}; use smaller integers, floats, or backend='gymnasium'") from None
    return state.view(np.uint8).reshape(-1)


def _attribute(env: Any, field: str) -> Any:
    name, *indices = field.split(".")
    value = getattr(env, name)
    for index in indices:
        value = value[int(index)]
    return value


def restore(record: np.dtype[Any], env: Any, memory: bytes) -> None:
    """Sets the attributes of an environment to those of a state.

    Args:
        record: The record with the observation.
        env: The environment, whose attributes have the right types.
        memory: The bytes of the state.
    """
    state = np.frombuffer(memory, np.uint8)[: record.itemsize].view(record)[0]
    for name, fields in _by_attribute(record):
        setattr(env, name, _like(getattr(env, name), [part.split(".")[1:] for part in fields], state, fields))


def _by_attribute(record: np.dtype[Any]) -> Iterator[tuple[str, list[str]]]:
    found: dict[str, list[str]] = {}
    for field in record.names or ():
        if field not in (OBSERVATION, "unused"):
            found.setdefault(field.partition(".")[0], []).append(field)
    yield from found.items()


def _like(example: Any, paths: list[list[str]], state: Any, fields: list[str]) -> Any:
    """Returns the value of an attribute, of the type of an example."""
    if isinstance(example, tuple | list):
        parts = []
        for i, item in enumerate(example):
            own = [(path[1:], field) for path, field in zip(paths, fields, strict=True) if path[0] == str(i)]
            parts.append(_like(item, [path for path, _ in own], state, [field for _, field in own]))
        return list(parts) if isinstance(example, list) else tuple(parts)
    value = state[fields[0]]
    if isinstance(example, np.ndarray):
        return np.array(value, dtype=example.dtype)
    if isinstance(example, np.generic):
        return value.astype(example.dtype)
    return value.item()
