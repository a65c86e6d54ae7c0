"""The action masks of a run: their source during training, and the masks known before the first episode."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._spec import ActionMasksSpec, MaskSourceSpec
from qtab.config.functions import FORGOTTEN, Mask, checked_mask
from qtab.discretizers import Discretizer, TimeAware
from qtab.discretizers.identity import Identity

MAX_KNOWN_STATES = 100_000
"""The most states for which masks are computed before the first episode."""


@dataclass(frozen=True, eq=False)
class ActionMasks:
    """The actions that each state allows."""

    source: MaskSourceSpec
    """The source of the mask of an observation, for an environment that is stepped in Python."""
    known: NDArray[np.bool_] | None = None
    """(rows, actions): the masks of all states, for an environment stepped in Rust."""

    def spec(self) -> ActionMasksSpec:
        """Returns the masks as the extension takes them."""
        if self.source["type"] == "none":
            return {"type": "none"}
        return {"type": "observed"} if self.known is None else {"type": "known", "available": self.known}


NO_MASKS = ActionMasks({"type": "none"})
"""No masks: every state allows all actions."""


def asks_for_masks(action_mask: Mask) -> bool:
    """Returns whether a run with this setting of ``action_mask`` has masks.

    Raises:
        ValueError: for the setting of a saved run whose function is not given.
    """
    if isinstance(action_mask, str):
        raise ValueError(FORGOTTEN)
    return action_mask is not False


def observed_masks(action_mask: Mask, env: gym.Env) -> ActionMasks:
    """Returns the masks of an environment that is stepped in Python; ``action_mask`` must ask for masks."""
    function = action_mask if callable(action_mask) else mask_method(env)
    return ActionMasks({"type": "info"} if function is None else {"type": "function", "function": function})


def mask_method(env: gym.Env) -> Callable[[Any], Any] | None:
    """Returns a function that calls ``env.action_masks()``, sb3-contrib's convention; None without one."""
    try:
        method = env.get_wrapper_attr("action_masks")
    except AttributeError:
        return None
    return lambda _observation: method()


def known_masks(action_mask: Mask, env: gym.Env, discretizer: Discretizer, n_actions: int) -> ActionMasks | None:
    """Returns the masks of all states of an environment stepped in Rust; None if they cannot be known in advance.

    The masks are known if observations are discrete, and either the environment has Taxi's method
    ``action_mask(state)`` or the setting is a function that returns a mask for each observation. For a state that is
    never reached, the function may raise a ``LookupError`` or return an invalid mask. Python then steps the
    environment, and reaching such a state raises an error.

    Args:
        action_mask: The setting; it must ask for masks.
        env: The environment.
        discretizer: Maps observations to rows.
        n_actions: The length of a mask.

    Raises:
        Exception: any other exception of the function, with a note that names the observation (Python 3.11 or later).
    """
    if isinstance(discretizer, TimeAware):
        of_cells = known_masks(action_mask, env, discretizer.cells, n_actions)
        if of_cells is None or of_cells.known is None:
            return None
        return replace(of_cells, known=np.tile(of_cells.known, (discretizer.max_episode_steps, 1)))
    function = action_mask if callable(action_mask) else getattr(env.unwrapped, "action_mask", None)
    if function is None or not isinstance(discretizer, Identity) or discretizer.n_rows > MAX_KNOWN_STATES:
        return None
    known = np.empty((discretizer.n_rows, n_actions), np.bool_)
    for row, observation in enumerate(_observations(discretizer)):
        try:
            mask = function(observation)
        except LookupError:
            return None
        except Exception as error:
            if hasattr(error, "add_note"):
                error.add_note(f"in action_mask({observation!r}), asked before the first episode")
            raise
        try:
            known[row] = checked_mask("action_mask", mask, n_actions)
        except (TypeError, ValueError):
            return None
    return ActionMasks({"type": "info"}, known)


def _observations(discretizer: Identity) -> Iterator[Any]:
    """Yields the observation of each row, in the types of Gymnasium's environments."""
    low = np.ravel(discretizer.low).tolist()
    for cell in np.ndindex(discretizer.shape):
        numbers = tuple(first + index for first, index in zip(low, cell, strict=True))
        yield numbers if discretizer.low.shape else numbers[0]


def mask_bytes(masks: ActionMasks, discretizer: Discretizer, n_actions: int) -> int:
    """Returns the memory that the masks take while a run trains, in bytes."""
    if masks.source["type"] == "none":
        return 0
    return n_actions * (math.prod(discretizer.shape) if discretizer.n_active == 1 else 1)
