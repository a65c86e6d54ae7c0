"""The action masks of a run: where training finds them, and those that are known before the first episode."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._spec import ActionMasksSpec, MaskSourceSpec
from qtab.config.action_mask import FORGOTTEN, Mask, checked_mask
from qtab.discretizers import Discretizer
from qtab.discretizers.identity import Identity

MAX_KNOWN_STATES = 100_000
"""For how many states a mask is computed before the first episode."""


@dataclass(frozen=True, eq=False)
class ActionMasks:
    """Which actions the states have."""

    source: MaskSourceSpec
    """Where an environment that is stepped in Python finds the mask of an observation."""
    known: NDArray[np.bool_] | None = None
    """(rows, actions): the masks of all states, for an environment that Rust steps."""

    def spec(self) -> ActionMasksSpec:
        """Returns the masks as the extension takes them."""
        if self.source["type"] == "none":
            return {"type": "none"}
        return {"type": "observed"} if self.known is None else {"type": "known", "available": self.known}


NO_MASKS = ActionMasks({"type": "none"})
"""Every state has all actions."""


def observed_masks(action_mask: Mask, env: gym.Env) -> ActionMasks:
    """Returns the masks of an environment that is stepped in Python, by the setting ``action_mask``.

    Raises:
        ValueError: for the setting of a saved run whose function is not given.
    """
    if action_mask is False:
        return NO_MASKS
    if isinstance(action_mask, str):
        raise ValueError(FORGOTTEN)
    function = mask_method(env) if action_mask is True else action_mask
    return ActionMasks({"type": "info"} if function is None else {"type": "function", "function": function})


def mask_method(env: gym.Env) -> Callable[[Any], Any] | None:
    """Returns a function that calls an environment's ``action_masks()``, sb3-contrib's convention; None without one."""
    try:
        method = env.get_wrapper_attr("action_masks")
    except AttributeError:
        return None
    return lambda _observation: method()


def known_masks(action_mask: Mask, env: gym.Env, discretizer: Discretizer, n_actions: int) -> ActionMasks | None:
    """Returns the masks of every state of an environment that Rust steps; None where they cannot be known.

    They are known where observations are discrete, and the environment has Taxi's method ``action_mask(state)`` or the
    setting is a function that gives each of them a mask.

    Raises:
        ValueError: for the setting of a saved run whose function is not given.
    """
    if action_mask is False:
        return NO_MASKS
    if isinstance(action_mask, str):
        raise ValueError(FORGOTTEN)
    function = getattr(env.unwrapped, "action_mask", None) if action_mask is True else action_mask
    if function is None or not isinstance(discretizer, Identity) or discretizer.n_rows > MAX_KNOWN_STATES:
        return None
    known = np.empty((discretizer.n_rows, n_actions), np.bool_)
    for row, observation in enumerate(_observations(discretizer)):
        try:
            known[row] = checked_mask("action_mask", function(observation), n_actions)
        except Exception:
            return None
    return ActionMasks({"type": "info"}, known)


def _observations(discretizer: Identity) -> Iterator[Any]:
    """Yields the observation of each row, in the types of Gymnasium's environments."""
    low = np.ravel(discretizer.low).tolist()
    for cell in np.ndindex(discretizer.shape):
        numbers = tuple(first + index for first, index in zip(low, cell, strict=True))
        yield numbers if discretizer.low.shape else numbers[0]


def mask_bytes(masks: ActionMasks, discretizer: Discretizer, n_actions: int) -> int:
    """Returns how many bytes the masks take while a run trains."""
    if masks.source["type"] == "none":
        return 0
    return n_actions * (math.prod(discretizer.shape) if discretizer.n_active == 1 else 1)
