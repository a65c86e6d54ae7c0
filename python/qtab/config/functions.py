"""Settings that may be functions, ``discretizer`` and ``action_mask``: what files store of them, and masks."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import shown


@dataclass(frozen=True)
class MissingFunction:
    """Placeholder for the function that was the discretizer of a saved run: files store only its name."""

    name: str

    def __call__(self, observation: Any) -> Any:  # noqa: ARG002
        """Raises an error that explains how to load the run with its function.

        Raises:
            ValueError: always.
        """
        raise ValueError(
            f"the run's discretizer is the function {self.name!r}, which a file cannot store: "
            "qtab.load(path, discretizer=...) restores it"
        )


def function_name(function: Callable[[Any], Any]) -> str:
    """Returns the name under which a saved run stores its function."""
    if isinstance(function, MissingFunction):
        return function.name
    return str(getattr(function, "__qualname__", type(function).__qualname__))


Mask: TypeAlias = bool | str | Callable[[Any], Any]
"""Whether the environment provides masks, or a function that does; ``STORED`` in the config of a run from a file."""

STORED = "function"
"""Placeholder for a function in a file, which cannot store functions."""
FORGOTTEN = (
    "action_mask must be given: the run was trained with a function, which its file cannot store; "
    "qtab.load(path, action_mask=f) restores it"
)


def mask_setting(name: str, value: Any) -> Mask:
    """Checks the value of the setting.

    Raises:
        TypeError: if it is neither a boolean nor a function.
    """
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if callable(value) or (isinstance(value, str) and value == STORED):
        checked: Mask = value
        return checked
    raise TypeError(
        f"{name} must be True (the environment gives the masks), False or a function of the observation, "
        f"got {shown(value)}"
    )


def checked_mask(name: str, mask: Any, n_actions: int) -> NDArray[np.bool_]:
    """Returns one mask as (actions,) booleans.

    Raises:
        TypeError: if it does not hold booleans or integers.
        ValueError: if it has another shape, holds other integers than 0 and 1, or leaves no action.
    """
    given = np.asarray(mask)
    if given.dtype.kind not in "bui":
        raise TypeError(f"{name} must be an array of {n_actions} booleans, one for each action, got {shown(mask)}")
    if given.shape != (n_actions,):
        raise ValueError(f"{name} must have shape ({n_actions},), with an item for each action, got {given.shape}")
    if not np.isin(given, (0, 1)).all():
        raise ValueError(f"{name} must hold booleans, or 0 and 1, got {shown(mask)}")
    if not given.any():
        raise ValueError(f"{name} must leave at least one action, got {shown(mask)}")
    return given.astype(np.bool_)
