"""``qtab/KArmedBandit-v0``: the k-armed bandit testbed (Sutton & Barto, 2nd ed., section 2.3)."""

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.config.value_checks import not_negative


class KArmedBanditEnv(gym.Env[Any, Any]):
    """A k-armed bandit: each action has a true value q*(a), and its rewards are normal with that mean and variance 1.

    The true values are drawn from a normal distribution by the first ``reset``, and again by each ``reset(seed=...)``;
    a ``reset()`` without a seed keeps the problem. There is one state. An episode is one step, and the next step may
    follow without a reset. ``info["optimal"]`` is whether the action had the largest true value.

    :func:`qtab.evaluate` draws the problem of its seed: ``seed=run.config.seed`` plays on the one of the
    training.

    With a learning rate of 1 that falls with the visits, a Q table holds the sample averages of the rewards.

    Args:
        k: The number of actions.
        mean: The mean of the true values.
        deviation: The standard deviation of the true values.
        random_walk: The standard deviation of the normal increments by which all true values change after each step; 0
            for a stationary problem. Exercise 2.5 has 0.01, with a ``deviation`` of 0.

    Attributes:
        action_values: (k,) float64: q*.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    action_values: NDArray[np.float64]

    def __init__(self, k: int = 10, mean: float = 0.0, deviation: float = 1.0, random_walk: float = 0.0) -> None:
        self.k = checks.integer("k", k, least=1)
        self.mean = checks.finite("mean", mean)
        self.deviation = not_negative("deviation", deviation)
        self.random_walk = not_negative("random_walk", random_walk)
        self.observation_space = gym.spaces.Discrete(1)
        self.action_space = gym.spaces.Discrete(self.k)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Starts an episode; the first time, and with a seed, draws a problem."""
        super().reset(seed=seed, options=options)
        if seed is not None or not hasattr(self, "action_values"):
            self.action_values = self.mean + self.deviation * self.np_random.standard_normal(self.k)
        return 0, {}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        """Draws a reward; with a random walk, also an increment for each true value.

        Raises:
            AssertionError: for an action outside the space.
        """
        assert self.action_space.contains(action), f"{action!r} ({type(action)}) invalid"  # noqa: S101
        reward = float(self.action_values[action]) + self.np_random.standard_normal()
        optimal = bool(action == np.argmax(self.action_values))
        if self.random_walk > 0:
            self.action_values = self.action_values + self.random_walk * self.np_random.standard_normal(self.k)
        return 0, reward, True, False, {"optimal": optimal}
