"""Ordinary classes with attributes that nothing reads, whose values Python may fail to compute."""

import math
from typing import Any

import numpy as np

from support.environments.gym_classes.vectors import DriftEnv

FULL, COST = 100.0, 0.5


class Counted(DriftEnv):
    """Without an error: numbers that are added, and conditions and sequences of a safe kind."""

    total: Any
    path: Any
    energy: Any
    limit: Any

    def reset(self, *, seed=None, options=None):
        self.total, self.last, self.path, self.is_left = 0, None, [], False
        self.energy, self.limit = FULL, math.inf
        return super().reset(seed=seed)

    def step(self, action):
        self.total += 0.5 * (action - 1)
        self.last = (action == 1 and 0.5) or -1
        self.path.extend(self.position)
        seen = (action, 1.0)
        self.path.extend(seen)
        self.energy -= COST
        self.limit -= 1
        self.path.append(2 if action else str(action))
        self.is_left = not action
        return super().step(action)


class BecomesNone(Counted):
    def step(self, action):
        if self.position[0] > 5.0:
            self.total = None
        return super().step(action)


class BecomesNoneBesides(Counted):
    def step(self, action):
        if self.position[0] > 5.0:
            self.total, self.last = None, 1
        return super().step(action)


class ExtendsByNumber(Counted):
    def step(self, action):
        self.path.extend(self.noise)
        return super().step(action)


class AppendsTwo(Counted):
    def step(self, action):
        self.path.append(action, action)
        return super().step(action)


class ReadsProperty(Counted):
    @property
    def share(self):
        return 1.0 / (self.position[1] - 7.0)

    def step(self, action):
        self.last = self.share
        return super().step(action)


class TruthOfArray(Counted):
    def step(self, action):
        self.last = self.position and 1.0
        return super().step(action)


class ChoiceByArray(Counted):
    def step(self, action):
        self.last = 2.0 if self.position else 1.0
        return super().step(action)


class AddsToText(Counted):
    def step(self, action):
        self.last = str(action) + 1  # type: ignore[operator]
        return super().step(action)


class SmallIntegers(Counted):
    few = np.int8(5)

    def step(self, action):
        self.last = self.few + 300
        return super().step(action)


class SmallIntegersOrOthers(Counted):
    few = np.int8(5)

    def step(self, action):
        self.last = (self.few if action else 1) + 300
        return super().step(action)


class SmallIntegersAtTimes(Counted):
    few = np.int8(5)
    strength: Any

    def reset(self, *, seed=None, options=None):
        self.strength = self.few
        return super().reset(seed=seed)

    def step(self, action):
        if action == 1:
            self.strength = 300
        self.strength += self.few
        return super().step(action)


class BooleansOfNumPy(Counted):
    flag = np.bool_(True)

    def step(self, action):
        self.last = self.flag - self.flag  # type: ignore[operator]
        return super().step(action)
