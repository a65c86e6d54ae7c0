"""Classes whose integers leave 64 bits, or the 53 bits of a float, for one action."""

import gymnasium as gym
import numpy as np


class Counts(gym.Env):
    """Action 1 makes the integer larger; action 0 shows it, and starts again."""

    action_space = gym.spaces.Discrete(2)
    observation_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.s = 1
        return 0, {}

    def larger(self):
        return self.s + 1

    def shown(self):
        return float(self.s)

    def step(self, action):
        if action == 1:
            self.s = self.larger()
            return 0, 0.0, False, False, {}
        reward = self.shown()
        self.s = 1
        return 0, reward, False, False, {}


class Doubles(Counts):
    def larger(self):
        return self.s * 2


class Adds(Counts):
    def larger(self):
        return self.s + self.s + 1


class Subtracts(Counts):
    def larger(self):
        return self.s - 5 + self.s if self.s < 0 else -self.s - 9


class Shifts(Counts):
    def shown(self):
        return float((1 << self.s) + (-7 >> self.s))


class Powers(Counts):
    def shown(self):
        return float(self.s**12)


class Sums(Counts):
    def larger(self):
        return sum([self.s, self.s, True])


class Compares(Counts):
    def larger(self):
        return self.s * 3 if self.s < 2**60 else self.s

    def shown(self):
        return float(self.s > float(self.s)) + float(0 < self.s <= float(self.s))


class Divides(Counts):
    def larger(self):
        return self.s * 3 if self.s < 2**60 else self.s

    def shown(self):
        return self.s / 3


class Unsigned(Counts):
    def reset(self, *, seed=None, options=None):
        self.bytes = np.array([3, 200], np.uint8)
        return super().reset(seed=seed)

    def shown(self):
        return float(int(self.bytes[0]) - int(self.bytes[1]))
