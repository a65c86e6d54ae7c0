"""Action masks in plain NumPy: a masked action has the value -inf."""

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.functions import FORGOTTEN


class ActionMasks:
    """The masks of the states, each as it was last seen."""

    def __init__(self, env: gym.Env, config: Config) -> None:
        if isinstance(config.action_mask, str):
            raise ValueError(FORGOTTEN)
        self.env, self.setting = env, config.action_mask
        self.of_state: dict[tuple[int, ...], NDArray[np.bool_]] = {}

    def see(self, state: list[int], observation: Any, info: dict[str, Any]) -> None:
        """Keeps the mask of a state, from a function, the environment's ``action_masks()`` or its info."""
        if self.setting is False:
            return
        if callable(self.setting):
            mask = self.setting(observation)
        elif self.env.has_wrapper_attr("action_masks"):
            mask = self.env.get_wrapper_attr("action_masks")()
        else:
            mask = info["action_mask"]
        self.of_state[tuple(state)] = np.asarray(mask).astype(bool)

    def masked(self, state: list[int], values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns action values, with -inf for the actions that the state does not have."""
        mask = self.of_state.get(tuple(state))
        return values if mask is None else np.where(mask, values, -np.inf)
