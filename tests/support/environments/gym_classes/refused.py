"""Classes that cannot be compiled, each for one reason; the comment ``# here`` marks the line."""

import math
import random
import time
from typing import Any

import gymnasium as gym
import numpy as np

from support.environments.gym_classes.walk import Base

COUNTER = [0]
SCORES: dict[str, int] = {}


class NumpyExp(Base):
    def change(self, action):
        return np.exp(-self.x * self.x)  # here


class Power(Base):
    def change(self, action):
        return -(self.x**2)  # here


class Formatted(Base):
    def change(self, action):
        self.text = f"x is {self.x}"  # here
        return float(len(self.text))


class DictState(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.visits = {}  # here
        return self.observe(), {}

    def change(self, action):
        self.visits[action] = 1
        return 0.0


class ListState(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.trail = [0, 0]
        return self.observe(), {}

    def change(self, action):
        self.trail.append(action)  # here
        return float(len(self.trail))


class TryExcept(Base):
    def change(self, action):
        try:  # here
            return 1.0 / self.x
        except ZeroDivisionError:
            return 0.0


class GlobalRandom(Base):
    def change(self, action):
        return random.random()  # here # noqa: S311


class NumpyRandom(Base):
    def change(self, action):
        return np.random.random()  # here # noqa: NPY002


class OwnGenerator(Base):
    def __init__(self):
        super().__init__()
        self.rng = np.random.default_rng(3)

    def change(self, action):
        return self.rng.random()  # here


class Clock(Base):
    def change(self, action):
        return time.time()  # here


class File(Base):
    def change(self, action):
        open("log.txt")  # here # noqa: PTH123, SIM115
        return 0.0


class Prints(Base):
    def change(self, action):
        print(self.x)  # here # noqa: T201
        return 0.0


class GlobalState(Base):
    def change(self, action):
        COUNTER[0] += 1  # here
        return float(COUNTER[0])


class GlobalStatement(Base):
    def change(self, action):
        global SCORES  # here
        SCORES = {}
        return 0.0


class MutableDefault(Base):
    def change(self, action, seen=[]):  # noqa: B006
        seen.append(action)  # here
        return 0.0


class CreatedLate(Base):
    def change(self, action):
        if self.x > 3:
            self.bonus = 1.0  # here
        return self.bonus if self.x > 3 else 0.0


class OptionalState(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.last = None  # here
        return self.observe(), {}

    def change(self, action):
        reward = 0.0 if self.last is None else float(self.last)
        self.last = action
        return reward


class ChangingType(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.flag = False
        return self.observe(), {}

    def change(self, action):
        self.flag = action  # here
        return float(self.flag)


class StringState(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.mood = "calm"  # here
        return self.observe(), {}

    def change(self, action):
        if action == 2:
            self.mood = "angry"
        return 1.0 if self.mood == "calm" else 0.0


class SharedArray(Base):
    def change(self, action):
        self.cells = self.start_cells  # here
        self.cells[0] += 1.0
        return float(self.cells[0])


class SharedLocal(Base):
    def change(self, action):
        cells = self.cells
        cells[0] = 1.0  # here
        return float(self.cells[0])


class SeedUsed(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        if seed is not None:  # here
            self.x = float(seed)
        return self.observe(), {}


class DrawsFirst(Base):
    def reset(self, *, seed=None, options=None):
        self.x = self.np_random.random()  # here
        super().reset(seed=seed)
        return self.observe(), {}


class NeverSeeds(Base):
    def reset(self, *, seed=None, options=None):  # here
        self.x = 1.0
        return self.observe(), {}


class ImpureInfo(Base):
    def step(self, action):
        self.x += 1.0
        return self.observe(), 0.0, self.x > 5, False, {"noise": self.np_random.random()}  # here


class ReadsInfo(Base):
    def step(self, action):
        observation, reward, terminated, truncated, info = super().step(action)
        if info.get("bonus"):  # here
            reward += 1.0
        return observation, reward, terminated, truncated, info


class SamplesSpace(Base):
    def change(self, action):
        return float(self.action_space.sample())  # here


class Shuffles(Base):
    def change(self, action):
        cells = np.zeros(3)
        self.np_random.shuffle(cells)  # here
        return float(cells[0])


class FloatSum(Base):
    def change(self, action):
        return float(np.sum(self.cells * 0.1))  # here


class SinglePrecision(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.speed = np.zeros(2, dtype=np.float32)
        return self.observe(), {}

    def change(self, action):
        return float(self.speed[0] * 0.1)  # here


class SignedZero(Base):
    def change(self, action):
        reward: Any = 0
        if action == 1:
            reward = 0.5
        return reward * self.velocity  # here


class RecursiveHelper(Base):
    def change(self, action):
        return self.depth(3)

    def depth(self, n):
        return 0.0 if n == 0 and self.x > 0 else self.depth(n)  # here


class Generates(Base):
    def cells_of(self):
        yield 1.0

    def change(self, action):
        return float(sum(self.cells_of()))  # here


class BigDict(Base):
    def change(self, action):
        table = {"a": self.x}
        return table[self.names[action]]  # here


class Hypotenuse(Base):
    def change(self, action):
        return math.hypot(self.x, 1.0)  # here


class ListObservation(Base):
    def observe(self):
        return [self.x]

    def reset(self, *, seed=None, options=None):
        gym.Env.reset(self, seed=seed)
        self.x = 0.0
        return self.observe(), {}  # here


class SometimesUnset(Base):
    def change(self, action):
        if self.x > 20:
            bonus = 5.0 + self.x
        return bonus if self.x > 20 else 0.0  # here


class ChangesDict(Base):
    def change(self, action):
        found = {"first": self.x, "second": 1.0}
        found["first"] = 2.0  # here
        return found["first"]


class ArrayCondition(Base):
    def change(self, action):
        return 1.0 if self.cells else 0.0  # here
