"""``qtab/MaximizationBias-v0``: why Double Q-learning (Sutton & Barto, 2nd ed., Example 6.7 and Figure 6.5)."""

import math
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils import checks

A, B, END = range(3)
RIGHT, LEFT = range(2)


class MaximizationBiasEnv(gym.Env[Any, Any]):
    """A, whence right ends the episode and left leads to B; there every action ends it with a normal reward.

    The mean reward of B lies below zero, so that left is always a mistake; yet the largest of B's estimates soon lies
    above. A has two actions: any other number goes left, too, and ``info["action_mask"]`` says which there are, as
    Gymnasium's Taxi does. A learner of this package is told by an ``initial_q`` with -inf, as the preset has it.

    Args:
        actions: How many actions B has. The book says "many".
        mean: Of B's rewards.
        deviation: Their standard deviation.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for fewer than two actions, or a number that is not finite.
    """

    def __init__(self, actions: int = 10, mean: float = -0.1, deviation: float = 1.0) -> None:
        self.observation_space = gym.spaces.Discrete(3)
        self.actions = checks.integer("actions", actions, least=2)
        self.action_space = gym.spaces.Discrete(self.actions)
        self.mean, self.deviation = checks.finite("mean", mean), checks.finite("deviation", deviation)
        self.state = END

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Begins in A, without a draw."""
        super().reset(seed=seed, options=options)
        self.state = A
        return self.state, self._info()

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        """Takes a step; in B it draws two numbers.

        Raises:
            AssertionError: for an action outside the space.
        """
        assert self.action_space.contains(action), f"{action!r} ({type(action)}) invalid"  # noqa: S101
        reward = 0.0
        if self.state == A and action != RIGHT:
            self.state = B
        else:
            if self.state == B:
                reward = self._normal()
            self.state = END
        return self.state, reward, self.state == END, False, self._info()

    def _normal(self) -> float:
        """By the method of Box and Muller (1958)."""
        u, v = self.np_random.random(), self.np_random.random()
        return self.mean + self.deviation * (math.sqrt(-2.0 * math.log(1.0 - u)) * math.cos(math.tau * v))

    def _info(self) -> dict[str, Any]:
        mask = np.ones(self.actions, np.int8)
        if self.state == A:
            mask[LEFT + 1 :] = 0
        return {"action_mask": mask}
