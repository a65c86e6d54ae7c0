"""The actions of an environment, by the columns of the table, and action masks: a masked action has the value -inf."""

import itertools
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config import Config
from qtab.config.functions import FORGOTTEN


def actions(env: gym.Env, config: Config) -> list[Any]:
    """Returns the actions as ``env.step`` takes them; for several components every combination, the last one fastest.

    Raises:
        TypeError: for an action space that cannot be enumerated.
    """
    space = env.action_space
    if isinstance(space, gym.spaces.Box) and config.actions is not None:
        if isinstance(config.actions, int):
            # Equal steps along each component, and every combination of them.
            steps = np.linspace(space.low.ravel(), space.high.ravel(), config.actions, dtype=space.dtype)
            return [np.array(action, dtype=space.dtype).reshape(space.shape) for action in itertools.product(*steps.T)]
        listed = required("actions", config.actions)
        return [np.array(action, dtype=space.dtype).reshape(space.shape) for action in listed]
    return all_actions(space)


def all_actions(space: gym.Space[Any]) -> list[Any]:
    """Returns every action of a discrete space: integers, arrays, tuples or dicts."""
    match space:
        case gym.spaces.Discrete():
            return [int(space.start) + action for action in range(int(space.n))]
        case gym.spaces.MultiDiscrete():
            ranges = [
                range(start, start + count)
                for start, count in zip(space.start.ravel().tolist(), space.nvec.ravel().tolist(), strict=True)
            ]
        case gym.spaces.MultiBinary():
            ranges = [range(2)] * int(np.prod(space.shape))
        case gym.spaces.Box() if space.dtype is not None and space.dtype.kind in "iub":
            ranges = [
                range(low, high + 1)
                for low, high in zip(space.low.ravel().tolist(), space.high.ravel().tolist(), strict=True)
            ]
        case gym.spaces.Tuple():
            return list(itertools.product(*map(all_actions, space.spaces)))
        case gym.spaces.Dict():
            combinations = itertools.product(*map(all_actions, space.spaces.values()))
            return [dict(zip(space.spaces, values, strict=True)) for values in combinations]
        case _:
            raise TypeError(f"the action space must have finitely many actions, got {space}")
    return [np.array(values, dtype=space.dtype).reshape(space.shape) for values in itertools.product(*ranges)]


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
