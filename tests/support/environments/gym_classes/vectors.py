"""Ordinary classes for vector environments: every kind of observation, action masks, draws, time limits, errors."""

import gymnasium as gym
import numpy as np
from gymnasium import spaces


class DriftEnv(gym.Env):
    """A vector of floats that is changed in place, with draws of a normal distribution."""

    observation_space = spaces.Box(-50.0, 50.0, (3,), np.float64)
    action_space = spaces.Discrete(3)

    def __init__(self, noise: float = 0.5) -> None:
        self.noise = noise
        self.position = np.zeros(3)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed, options=options)
        self.position[:] = self.np_random.normal(0.0, 1.0)
        return self.position.copy(), {}

    def step(self, action):
        self.position[action] += self.np_random.normal(0.0, self.noise)
        info: dict[str, int] = {}
        return self.position.copy(), self.position[0] / 3.0, bool(self.position[2] > 1.2), False, info


class LockEnv(gym.Env):
    """A wheel with action masks in the info dict, observations and actions that do not begin at 0."""

    observation_space = spaces.Discrete(12, start=4)
    action_space = spaces.Discrete(3, start=-1)

    def __init__(self) -> None:
        self.wheel, self.open = 0, 0

    def action_masks(self):
        return np.array([self.wheel > 0, self.open < 3, self.wheel < 11])

    def _info(self):
        return {"action_mask": self.action_masks()}

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        start = 0 if options is None else options.get("start", 5)
        self.wheel, self.open = int(self.np_random.integers(2, 8)) if start == 0 else start, 0
        return self.wheel + 4, self._info()

    def step(self, action):
        self.wheel = min(max(self.wheel + int(action), 0), 11)
        if action == 0 and self.np_random.random() < 0.3:
            self.open += 1
        return self.wheel + 4, float(self.open), self.open == 3, False, self._info()


class MaskedRowEnv(gym.Env):
    """A mask of integers that only the info dict has, and an end of its own after some steps."""

    observation_space = spaces.Discrete(12, start=4)
    action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.wheel, self.steps = int(self.np_random.integers(0, 6)), 0
        return self.wheel + 4, {"action_mask": np.array([1, self.wheel < 8], dtype=np.int8)}

    def step(self, action):
        self.steps += 1
        self.wheel = (self.wheel + 2 * int(action)) % 11
        mask = {"action_mask": np.array([1, self.wheel < 8], dtype=np.int8)}
        return self.wheel + 4, -1.0, self.wheel == 10, self.steps >= 7, mask


class RoomsEnv(gym.Env):
    """Observations are dicts with a number, an array and a tuple."""

    action_space = spaces.Discrete(4)

    def __init__(self) -> None:
        inner = spaces.Tuple((spaces.Discrete(5), spaces.MultiBinary(2)))
        cell = spaces.Box(0, 4, (2,), np.int64)
        self.observation_space = spaces.Dict({"room": spaces.Discrete(3), "cell": cell, "rest": inner})
        self.room, self.steps = 0, 0
        self.cell = np.zeros(2, np.int64)

    def _observation(self):
        lights = np.array([self.steps % 2, self.room == 1], dtype=np.int8)
        return {"room": self.room, "cell": self.cell.copy(), "rest": (self.steps % 5, lights)}

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.room, self.steps = int(self.np_random.integers(0, 3)), 0
        self.cell[:] = 2
        return self._observation(), {}

    def step(self, action):
        self.steps += 1
        axis, change = action // 2, 2 * (action % 2) - 1
        self.cell[axis] = min(max(self.cell[axis] + change, 0), 4)
        if self.np_random.random() < 0.2:
            self.room = (self.room + 1) % 3
        found = bool(self.cell[0] == 4 and self.room == 2)
        return self._observation(), 1.0 if found else -0.1, found, self.steps >= 15, {}


class FragileEnv(gym.Env):
    """Action 2 raises an error from the third step on, and so does a reset that draws an unlucky number.

    Action 3 divides by 0, an integer of NumPy's in a vector environment, so that the result is infinite.
    """

    observation_space = spaces.Box(-1e6, 1e6, (1,), np.float64)
    action_space = spaces.Discrete(4)

    def __init__(self, unlucky: float = -1.0) -> None:
        self.unlucky = unlucky

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        chance = self.np_random.random()
        if chance == self.unlucky:
            raise ValueError("no first state")
        self.level, self.steps = 4.0 * chance, 0
        return np.array([self.level]), {}

    def step(self, action):
        self.steps += 1
        if action == 2 and self.steps > 2:
            raise KeyError("the second action")
        if action == 3:
            self.level = 1.0 / (action - 3)
        else:
            self.level -= action * self.np_random.random()
        return np.array([self.level]), self.level, self.level < 0.0, False, {}


class GrowingEnv(gym.Env):
    """An integer that leaves 64 bits within an episode, after which Python steps all sub-environments."""

    observation_space = spaces.Discrete(100)
    action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.number, self.steps = int(self.np_random.integers(1, 4)), 0
        return self.number % 100, {}

    def step(self, action):
        self.steps += 1
        if action == 1:
            self.number = self.number * 1_000_003 + 7
        return self.number % 100, 0.5, self.steps >= 6, False, {}
