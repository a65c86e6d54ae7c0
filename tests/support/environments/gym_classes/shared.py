"""Classes in which two names refer to the same memory, which is changed in place; ``# here`` marks the line."""

import gymnasium as gym
import numpy as np

from support.environments.gym_classes.walk import Base


class FollowsAttribute(Base):
    def change(self, action):
        before = self.cells  # here
        self.cells[0] += 1.0
        return float(before[0])


class FollowsPart(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.board = np.zeros((2, 2))
        return self.observe(), {}

    def change(self, action):
        row = self.board[0]  # here
        self.board[0, 1] = action
        return float(row[1])


class FollowsInAnotherAttribute(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.before = self.cells  # here
        return self.observe(), {}

    def change(self, action):
        reward = float(self.before[0])
        self.cells[0] += 1.0
        return reward


class FollowsThroughHelper(Base):
    def values(self):
        return self.cells

    def change(self, action):
        before = self.values()  # here
        self.cells += 1.0
        return float(before[0])


class FollowsInParameter(Base):
    def shift(self, cells):
        self.cells[1] += 2.0
        return float(cells[1])

    def change(self, action):
        return self.shift(self.cells)  # here


class FollowsList(Base):
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.place = [0, 0]
        return self.observe(), {}

    def change(self, action):
        place = self.place  # here
        self.place[0] = action
        return float(place[0])


class FollowsInLoop(Base):
    def change(self, action):
        total = 0.0
        for cell in self.cells:  # here
            self.cells[1] += 1.0
            total += cell
        return total


class ReadsOnly(Base):
    """Compiles: nothing is changed in place where two names refer to the same memory."""

    def total(self, cells):
        first, second = cells
        return float(first + second)

    def change(self, action):
        self.cells[0] += 1.0
        return self.total(self.cells)


class CopiesFirst(Base):
    """Compiles: the copy does not change."""

    def change(self, action):
        before = self.cells.copy()
        self.cells[0] += action
        after = self.cells[0]
        return float(before[0] - after)


class SharesInInit(gym.Env):
    """Two attributes are the same array from the beginning."""

    def __init__(self) -> None:
        walk = Base()
        self.observation_space, self.action_space = walk.observation_space, walk.action_space
        self.counts = np.zeros(3)
        self.shown = self.counts

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.x = 0.0
        self.counts[:] = 0.0
        return np.array([self.x]), {}

    def step(self, action):
        self.counts[action] += 1.0
        self.x = float(self.shown[0])
        return np.array([self.x]), 0.0, self.x > 5, False, {}
