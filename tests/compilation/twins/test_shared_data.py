"""Attributes that share memory, and data that looks like plain data, are not compiled to other numbers."""

import re
from collections import deque
from dataclasses import dataclass, field
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab

pytest.importorskip("numba")

MAP = np.arange(12.0)
PAIR = (np.zeros(2), 1)
SEEN: deque[int] = deque()


class Base(gym.Env):
    observation_space = gym.spaces.Discrete(6)
    action_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        self.begin()
        return 0, {}

    def begin(self):
        pass

    def reward(self):
        return 1.0

    def step(self, action):
        self.cell = min(self.cell + int(action), 5)
        return self.cell, float(self.reward()), self.cell == 5, False, {}


class View(Base):
    def __init__(self):
        self.grid = np.zeros((2, 6))
        self.row = self.grid[1]

    def reward(self):
        self.grid[1, self.cell] += 1.0
        return self.row[self.cell]


class ModuleArray(Base):
    def __init__(self):
        self.grid = MAP

    def begin(self):
        self.grid[:] = 0.0

    def reward(self):
        return MAP[self.cell]


class Memory:
    def __init__(self):
        self.grid = np.zeros(6)


class HelperObject(Base):
    def __init__(self):
        self.memory = Memory()
        self.grid = self.memory.grid

    def reward(self):
        self.grid[self.cell] += 1.0
        return self.memory.grid[self.cell]


class Clamped:
    def __set__(self, env, value):
        env.__dict__["level"] = min(value, 3)

    def __get__(self, env, owner=None):
        return env.__dict__["level"]


class Descriptor(Base):
    level = Clamped()

    def begin(self):
        self.level = 0

    def reward(self):
        self.level = self.level + 1
        return self.level


class PrivateName(Base):
    def __worth(self):
        SEEN.append(self.cell)
        return 1.0

    def reward(self):
        return self.__worth()


class MutableDefault(Base):
    def reward(self, seen=[]):  # noqa: B006 - the mistake under test
        seen.append(1)
        return len(seen)


class ModuleDeque(Base):
    def reward(self):
        SEEN.append(1)
        return len(SEEN)


class ArrayInTuple(Base):
    def reward(self):
        counts = PAIR[0]
        counts[0] += 1.0
        return counts[0]


class Counted(int):
    def __add__(self, other):
        SEEN.append(1)
        return int(self) + other


class SubclassOfInt(Base):
    def __init__(self):
        self.stride = Counted(1)

    def reward(self):
        return self.stride + 1


@dataclass
class Wind:
    strength: float = 1.0

    @property
    def doubled(self):
        SEEN.append(1)
        return 2 * self.strength


class PropertyOfADataclass(Base):
    def __init__(self):
        self.wind = Wind()

    def reward(self):
        return self.wind.doubled


@dataclass
class Drawn:
    number: int = field(default_factory=lambda: SEEN.append(1) or 1)  # type: ignore[func-returns-value]


class DefaultFactory(Base):
    def reward(self):
        return Drawn().number


@pytest.mark.parametrize(
    ("cls", "reason"),
    [
        (View, "self.grid is changed in place, and shares memory with self.row"),
        (ModuleArray, "self.grid is changed in place, and shares memory with a value outside of the environment"),
        (HelperObject, "self.grid is changed in place, and shares memory with self.memory"),
        (Descriptor, "self.level is a descriptor of its class"),
        (PrivateName, "self.__worth is a private name"),
        (MutableDefault, "a list is changed in `seen.append(1)`"),
        (ModuleDeque, "the attribute append of an object of type deque"),
        (ArrayInTuple, "other than an array of self in `counts[0] += 1.0`"),
        (SubclassOfInt, "`self.stride` is an object of type Counted"),
        (PropertyOfADataclass, "`self.wind"),
        (DefaultFactory, "an object of type Drawn is made"),
    ],
)
def test_such_data_is_refused_and_left_as_it_is(cls: Any, reason: str) -> None:
    before = MAP.tobytes(), PAIR[0].tobytes(), list(SEEN)
    with pytest.raises(ValueError, match=re.escape(reason)):
        qtab.train(cls(), episodes=5, max_episode_steps=20, seed=0, backend="numba")
    assert (MAP.tobytes(), PAIR[0].tobytes(), list(SEEN)) == before
    MutableDefault.reward.__defaults__[0].clear()  # type: ignore[index]


@dataclass(slots=True)
class Slotted:
    stride: int = 2


class SlottedConstants(Base):
    def __init__(self):
        self.constants = Slotted()

    def reward(self):
        return self.constants.stride


def test_a_dataclass_with_slots_is_a_constant() -> None:
    runs = [
        qtab.train(SlottedConstants(), episodes=20, max_episode_steps=20, seed=0, backend=backend)
        for backend in ("numba", "python")
    ]
    assert runs[0].tables.tobytes() == runs[1].tables.tobytes()
