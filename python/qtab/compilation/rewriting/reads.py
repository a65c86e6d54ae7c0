"""The constants that a compiled class was made with, to notice when one has changed."""

import copy
from collections.abc import Callable
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from gymnasium import spaces

from qtab.envs.class_code import is_of_library


class Reads:
    """The constants that were read: attributes, globals and class attributes, with their values at the time."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, str], tuple[str, Callable[[], Any], Any]] = {}
        self._owners: list[Any] = []

    def note(self, owner: Any, name: str, shown: str, read: Callable[[], Any], value: Any) -> None:
        """Notes that a constant was read.

        Args:
            owner: The object, class or namespace that has it.
            name: Its name there.
            shown: The name for messages.
            read: Returns its current value.
            value: The value now.
        """
        if (id(owner), name) not in self._known and not isinstance(value, ModuleType):
            self._owners.append(owner)
            self._known[id(owner), name] = shown, read, snapshot(value)

    def changed(self) -> str | None:
        """Returns the name of a constant that is different now; None if all are the same."""
        for shown, read, value in self._known.values():
            try:
                now = snapshot(read())
            except (AttributeError, KeyError, ValueError):
                return shown
            if now != value:
                return shown
        return None


def snapshot(value: Any) -> Any:
    """Returns what identifies a constant; equal constants have equal snapshots."""
    if isinstance(value, np.ndarray | np.generic) and not value.dtype.hasobject:
        return type(value), value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, float):
        return float, value.hex()
    if isinstance(value, tuple | list):
        return type(value), tuple(map(snapshot, value))
    if isinstance(value, dict):
        return dict, tuple((snapshot(key), snapshot(part)) for key, part in value.items())
    if isinstance(value, set | frozenset):
        return set, frozenset(map(snapshot, value))
    if isinstance(value, FunctionType):
        return FunctionType, id(value), value.__code__, snapshot(value.__defaults__), snapshot(value.__kwdefaults__)
    if isinstance(value, spaces.Space):
        return type(value), repr(value)
    if isinstance(value, type) or is_of_library(type(value)):
        return id(value)
    try:
        hash(value)
    except TypeError:
        return id(value)
    return type(value), copy.copy(value) if isinstance(value, int | str | bytes) else id(value)
