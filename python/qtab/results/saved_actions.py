"""The file format of the actions of a run: arrays, and for composite actions a description in JSON."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.config.value_checks import MAX_ACTIONS
from qtab.envs.actions import ActionParts, Actions

_KINDS = "biu"


def describe_parts(actions: Actions) -> Any:
    """Returns composite actions as JSON data."""
    if actions.composite is not None:
        parts = [describe_parts(part) for part in actions.composite.parts]
        keys = actions.composite.keys
        return {"parts": parts, "keys": None if keys is None else list(keys)}
    if actions.values is not None:
        return {"dtype": actions.values.dtype.name, "values": actions.values.tolist()}
    return {"count": actions.count, "first": actions.first}


def restore_actions(count: int, first: int, values: NDArray[Any] | None, description: Any) -> Actions:
    """Returns the actions in a file, after checking them.

    Raises:
        KeyError: if a part is missing.
        ValueError: if no action space has such actions.
    """
    if description is None:
        return Actions(count, first, values)
    actions = _restore(description)
    if actions.composite is None or actions.count != count or first != 0:
        raise ValueError("its actions contradict each other")
    return actions


def _restore(stored: Any) -> Actions:
    if not isinstance(stored, dict):
        raise ValueError(f"a part of its actions must be a JSON object, got {stored!r}")
    if "parts" in stored:
        parts, keys = tuple(map(_restore, stored["parts"])), stored["keys"]
        if keys is not None:
            keys = tuple(keys)
            if len(keys) != len(parts) or not all(isinstance(key, str) for key in keys):
                raise ValueError("the keys of its actions do not fit")
        count = math.prod(map(len, parts))
        _check_count(count)
        return Actions(count, composite=ActionParts(parts, keys))
    if "values" in stored:
        dtype = np.dtype(stored["dtype"])
        values = np.array(stored["values"])
        if dtype.kind not in _KINDS or values.dtype.kind not in _KINDS or not values.ndim:
            raise ValueError("the parts of its actions must be integers")
        _check_count(len(values))
        return Actions(len(values), values=values.astype(dtype))
    count, first = stored["count"], stored["first"]
    if type(count) is not int or type(first) is not int:
        raise ValueError(f"a part of its actions must have a count and a first action, got {stored!r}")
    _check_count(count)
    return Actions(count, first)


def _check_count(count: int) -> None:
    if not 1 <= count <= MAX_ACTIONS:
        raise ValueError(f"its actions must be 1 to {MAX_ACTIONS}, got {count}")
