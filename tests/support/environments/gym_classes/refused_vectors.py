"""Ordinary classes that show more in a vector environment than compiled code gives."""

import itertools

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from support.environments.gym_classes.vectors import DriftEnv, LockEnv

SHARED = np.zeros(3)
NUMBERS = itertools.count()


class SharesMemory(DriftEnv):
    def __init__(self, noise: float = 0.5) -> None:
        super().__init__(noise)
        self.position = SHARED


class ClassArray(DriftEnv):
    position = np.zeros(3)

    def __init__(self, noise: float = 0.5) -> None:
        self.noise = noise


class Random(DriftEnv):
    def __init__(self) -> None:
        super().__init__(np.random.default_rng().random())


class ShowsView(DriftEnv):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.position, {}

    def step(self, action):
        self.position[action] += 1.0
        return self.position, 0.0, bool(self.position[1] > 5.0), False, {}


class ShowsViewAtTheEnd(DriftEnv):
    def _last(self):
        return np.asarray(self.position)

    def step(self, action):
        self.position[action] += 1.0
        if self.position[action] > 3.0:
            return self._last(), 0.0, True, False, {}
        return self.position.copy(), 0.0, False, False, {}


class ShowsParameter(DriftEnv):
    def _same(self, given):
        return given

    def step(self, action):
        self.position[action] += 1.0
        return self._same(self.position[:]), 0.0, bool(self.position[1] > 5.0), False, {}


class OtherDtype(DriftEnv):
    observation_space = spaces.Box(0, 50, (3,), np.uint8)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return np.zeros(3, np.int64), {}

    def step(self, action):
        return np.ones(3, np.int64), 0.0, False, False, {}


class Doubles(OtherDtype):
    observation_space = spaces.Box(-50.0, 50.0, (3,), np.float32)


class Informs(DriftEnv):
    def step(self, action):
        info = {"speed": 1.0}
        return self.position.copy(), 0.0, False, False, info


class ChangesInfo(DriftEnv):
    def step(self, action):
        info = {}
        if action == 1:
            info["late"] = True
        return self.position.copy(), 0.0, False, False, info


class PassesInfoOn(DriftEnv):
    def step(self, action):
        observation, reward, terminated, truncated, info = super().step(action)
        return observation, 2.0 * reward, terminated, truncated, info


class OneMask(LockEnv):
    def step(self, action):
        return 5, 0.0, False, False, {}


class OtherMask(LockEnv):
    def _info(self):
        return {"action_mask": np.array([True, self.wheel > 3, True])}


class MaskOfBase(LockEnv):
    def action_masks(self):
        return np.array([False, True, True])

    def _info(self):
        return {"action_mask": super().action_masks()}


class NoOptions(DriftEnv):
    def reset(self, *, seed=None):  # type: ignore[override]
        super().reset(seed=seed)
        return self.position.copy(), {}


class DefaultOptions(DriftEnv):
    def reset(self, *, seed=None, options={"far": 1}):  # noqa: B006
        super().reset(seed=seed)
        return self.position.copy(), {}


class Prints(DriftEnv):
    def step(self, action):
        print(action)  # noqa: T201
        return self.position.copy(), 0.0, False, False, {}


class Resets(DriftEnv):
    def __init__(self, noise: float = 0.5) -> None:
        super().__init__(noise)
        self.reset()


class Divides(DriftEnv):
    def step(self, action):
        self.share = 1.0 / (self.position[1] - 7.0)
        return super().step(action)


class AddsUp(DriftEnv):
    def __init__(self, noise: float = 0.5) -> None:
        super().__init__(noise)
        self.total = 0.0

    def step(self, action):
        self.total += self.position[7]
        return super().step(action)


class Warns(DriftEnv):
    def step(self, action):
        if self.position[1] > 7.0:
            gym.logger.warn("far away")
        return super().step(action)


class Keeps(DriftEnv):
    def __init__(self, noise: float = 0.5) -> None:
        super().__init__(noise)
        self.steps = 0

    def step(self, action):
        self.steps += 1
        return super().step(action)


class Numbered(DriftEnv):
    """Its copies differ in what no step reads, and its steps keep numbers that cannot fail."""

    def __init__(self, noise: float = 0.5) -> None:
        super().__init__(noise)
        self.number = next(NUMBERS)

    def reset(self, *, seed=None, options=None):
        self.total, self.last, self.name, self.before = 0.0, None, "none", None
        return super().reset(seed=seed)

    def step(self, action):
        self.last = (action, action == 1)
        self.total += 0.5 * float(action)
        self.name = "right" if action == 1 else "left"
        self.before = self.position.copy()
        return super().step(action)
