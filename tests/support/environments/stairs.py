"""One small environment in two forms that Numba compiles: functions of a state, and an ordinary class."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab

FIRST, LAST = 3, 9
"""The first and the last stair. They and the actions do not count from 0."""


def register() -> None:
    """Registers both forms with Gymnasium, also in a worker process."""
    gym.register("tests/Stairs-v0", "support.environments.stairs:Stairs", max_episode_steps=30)
    gym.register("tests/OrdinaryStairs-v0", "support.environments.stairs:OrdinaryStairs", max_episode_steps=30)


class Stairs(qtab.FunctionalEnv):
    """Leads from the lowest stair to the highest by steps of -1, 0 or 1, and a step may slip."""

    observation_space = gym.spaces.Discrete(LAST - FIRST + 1, start=FIRST)
    action_space = gym.spaces.Discrete(3, start=-1)

    def __init__(self, slip: float = 0.25) -> None:
        self.slip = slip

    def initial_state(self, rng: np.random.Generator) -> Any:
        return FIRST + rng.integers(0, 2)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        following = state if rng.random() < self.slip else min(max(state + action, FIRST), LAST)
        return following, -1.0, following == LAST

    def observe(self, state: Any) -> Any:
        return state

    def action_mask(self, state: Any) -> Any:
        mask = np.ones(3, np.bool_)
        if state == FIRST:
            mask[0] = False
        return mask


class OrdinaryStairs(gym.Env[Any, Any]):
    """The same as an ordinary class."""

    def __init__(self, slip: float = 0.25) -> None:
        self.slip = slip
        self.observation_space = gym.spaces.Discrete(LAST - FIRST + 1, start=FIRST)
        self.action_space = gym.spaces.Discrete(3, start=-1)

    def _mask(self) -> Any:
        mask = np.ones(3, np.int8)
        if self.stair == FIRST:
            mask[0] = 0
        return mask

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        self.stair = FIRST + int(self.np_random.integers(0, 2))
        return self.stair, {"action_mask": self._mask()}

    def step(self, action: Any) -> Any:
        if self.np_random.random() >= self.slip:
            self.stair = min(max(self.stair + int(action), FIRST), LAST)
        return self.stair, -1.0, self.stair == LAST, False, {"action_mask": self._mask()}
