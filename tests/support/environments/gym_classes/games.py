"""Games: dice, cards, boards, bandits."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

LINES = ((0, 1, 2), (3, 4, 5), (6, 7, 8), (0, 3, 6), (1, 4, 7), (2, 5, 8), (0, 4, 8), (2, 4, 6))


class DiceEnv(gym.Env):
    """Rolls until it stops or rolls a one; returns the pair of reset from a helper."""

    def __init__(self, target: int = 20, sides: int = 6) -> None:
        self.target, self.sides = target, sides
        self.observation_space = spaces.Tuple([spaces.Discrete(target + sides + 1), spaces.Discrete(sides + 1)])
        self.action_space = spaces.Discrete(2)

    def _result(self):
        return (min(self.score, self.target + self.sides), self.last), {}

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.score, self.last = 0, 0
        return self._result()

    def step(self, action):
        if action == 0:
            return self._result()[0], float(self.score), True, False, {}
        self.last = int(self.np_random.integers(1, self.sides + 1))
        if self.last == 1:
            self.score = 0
            return self._result()[0], 0.0, True, False, {}
        self.score += self.last
        return self._result()[0], 0.0, self.score >= self.target, False, {}


class TicTacToeEnv(gym.Env):
    """Against a random opponent; masks by a method, generators over constant lines, a while loop."""

    def __init__(self) -> None:
        self.observation_space = spaces.MultiDiscrete([3] * 9)
        self.action_space = spaces.Discrete(9)
        self.board = np.zeros(9, dtype=np.int64)

    def action_masks(self):
        return self.board == 0

    def _wins(self, player):
        return any(all(self.board[cell] == player for cell in line) for line in LINES)

    def _is_full(self):
        return not (self.board == 0).any()

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.board = np.zeros(9, dtype=np.int64)
        if self.np_random.random() < 0.5:
            self.board[self.np_random.integers(9)] = 2
        return self.board.copy(), {}

    def step(self, action):
        if self.board[action] != 0:
            return self.board.copy(), -1.0, True, False, {"illegal": True}
        self.board[action] = 1
        if self._wins(1):
            return self.board.copy(), 1.0, True, False, {}
        if self._is_full():
            return self.board.copy(), 0.0, True, False, {}
        cell = self.np_random.integers(9)
        while self.board[cell] != 0:
            cell = self.np_random.integers(9)
        self.board[cell] = 2
        if self._wins(2):
            return self.board.copy(), -1.0, True, False, {}
        return self.board.copy(), 0.0, self._is_full(), False, {}


class BanditEnv(gym.Env):
    """A bandit whose means drift; a copy made with np.copy, and the best arm found in a loop."""

    def __init__(self, arms: int = 4) -> None:
        self.arms = arms
        self.observation_space = spaces.Discrete(1)
        self.action_space = spaces.Discrete(arms)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.means = self.np_random.normal(0.0, 1.0, size=self.arms)
        self.pulls = 0
        return 0, {}

    def step(self, action):
        reward = self.np_random.normal(self.means[action], 1.0)
        before = np.copy(self.means)
        self.means += self.np_random.normal(0.0, 0.05, self.arms)
        best = 0
        for arm, mean in enumerate(self.means):
            if mean > self.means[best]:
                best = arm
        self.pulls += 1
        reward += 0.1 * (self.means[best] - before[best])
        return 0, reward, False, self.pulls >= 40, {}


class BaseGame(gym.Env):
    """A base class of the user, with hooks that subclasses override."""

    lives = 3

    def __init__(self, length: int = 12) -> None:
        super().__init__()
        self.length = length
        self.observation_space = spaces.Box(0, 255, (2,), dtype=np.uint8)
        self.action_space = spaces.Discrete(3)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        super().reset(seed=seed)
        if options is not None:
            self.length = options["length"]
        self.place = 0
        self.left = self.lives
        return self.observation(), {}

    def observation(self):
        return np.array([self.place, self.left], dtype=np.uint8)

    def move(self, action, boost=1):
        return (action - 1) * boost

    def step(self, action):
        self.place = max(0, self.place + self.move(action))
        if self.np_random.random() < 0.05:
            self.left -= 1
        done = self.place >= self.length or self.left == 0
        reward = 1 if self.place >= self.length else 0
        return self.observation(), reward, done, False, {}


class RunningGame(BaseGame):
    """Overrides the move, and calls the step of its base class."""

    lives = 5

    def move(self, action, boost=2):
        return super().move(action, boost=boost)

    def step(self, action):
        observation, reward, terminated, truncated, info = super().step(action)
        info["running"] = True
        reward = reward * 10 - 0.5
        return observation, reward, terminated, truncated, info


class GamblerEnv(gym.Env):
    """Stakes on a coin; total steps over all episodes are kept, in a record that outlives resets."""

    def __init__(self, goal: int = 20, heads: float = 0.45) -> None:
        self.goal, self.heads = goal, heads
        self.observation_space = spaces.Discrete(goal + 1)
        self.action_space = spaces.Discrete(3, start=1)
        self.flips = 0
        self.episodes = 0

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.capital = self.np_random.choice([5, 8, 10])
        self.episodes += 1
        return int(self.capital), {"episodes": self.episodes}

    def step(self, action):
        stake = min(action, self.capital, self.goal - self.capital)
        self.flips += 1
        chance = self.heads if self.flips % 2 == 0 else self.heads + 0.02 * (self.episodes % 3)
        if self.np_random.random() < chance:
            self.capital += stake
        else:
            self.capital -= stake
        reward = 1.0 if self.capital >= self.goal else 0.0
        return int(self.capital), reward, not 0 < self.capital < self.goal, False, {}
