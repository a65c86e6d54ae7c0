"""``qtab/MaximizationBias-v0``: the case for Double Q-learning (Sutton & Barto, 2nd ed., Example 6.7, Figure 6.5)."""

import math
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks

A, B, END = range(3)
RIGHT, LEFT = range(2)


class MaximizationBiasEnv(gym.Env[Any, Any]):
    """The two-state Markov decision process of Example 6.7, on which Q-learning suffers from maximization bias.

    Episodes start in state A. Right ends the episode with reward 0; left leads to state B with reward 0. Every action
    in B ends the episode with a normally distributed reward. The mean of that reward is negative, so left is always a
    mistake, but the largest estimated value in B is positive early in training.

    State A has only the actions right (0) and left (1); larger numbers act as left. ``info["action_mask"]``, (actions,)
    int8, marks the valid actions, as in Gymnasium's Taxi. A learner of this package excludes the others by -inf in
    ``initial_q``, as the preset does, or with ``action_mask=True``.

    Args:
        actions: The number of actions in B. The book says "many".
        mean: The mean reward in B.
        deviation: The standard deviation of the reward in B.

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
        """Starts an episode in A; no random number is drawn."""
        super().reset(seed=seed, options=options)
        self.state = A
        return self.state, self._info()

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        """Takes a step; a step from B draws two random numbers.

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
        """Returns a normally distributed reward by the method of Box and Muller (1958)."""
        u, v = self.np_random.random(), self.np_random.random()
        return self.mean + self.deviation * (math.sqrt(-2.0 * math.log(1.0 - u)) * math.cos(math.tau * v))

    def action_mask(self, state: int) -> NDArray[np.int8]:
        """Returns (actions,): 1 for the actions that a state has."""
        mask = np.ones(self.actions, np.int8)
        if state == A:
            mask[LEFT + 1 :] = 0
        return mask

    def _info(self) -> dict[str, Any]:
        return {"action_mask": self.action_mask(self.state)}
