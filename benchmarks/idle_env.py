"""The time that learning adds to an environment that is stepped in Python."""

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

import qtab
from tables import Column, Table, added_time

EPISODES, EPISODE_STEPS = 100, 200
BARE, LEARNING = "an idle environment in a bare Python loop", "qtab.train on the idle environment"


class IdleEnv(gym.Env[NDArray[np.float32], Any]):
    """An environment that does as little as possible: every step returns the same observation and a reward of -1."""

    observation_space = gym.spaces.Box(0.0, 1.0, (2,), np.float32)
    action_space = gym.spaces.Discrete(3)

    def __init__(self) -> None:
        self._step: Any = np.full(2, 0.5, np.float32), -1.0, False, False, {}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        """Returns the observation."""
        super().reset(seed=seed, options=options)
        return self._step[0], {}

    def step(self, action: int) -> Any:  # noqa: ARG002 - it has no effect
        """Returns the observation, a reward of -1, and flags that are False."""
        return self._step


def learning() -> Table:
    """Returns the table of the idle environment: stepping only, and learning on a grid of 10 x 10 cells."""
    env = IdleEnv()

    def bare(index: int) -> int:
        step = env.step
        for episode in range(EPISODES):
            env.reset(seed=None if episode else index)  # as qtab.train does
            for _ in range(EPISODE_STEPS):
                _, _, terminated, truncated, _ = step(1)
                if terminated or truncated:
                    break
        return EPISODES * EPISODE_STEPS

    def learn(index: int) -> int:
        settings: dict[str, Any] = {"episodes": EPISODES, "max_episode_steps": EPISODE_STEPS, "scale": (10, 10)}
        return int(qtab.train(env, seed=index, progress=False, **settings).episode_lengths.sum())

    title = "Learning on an environment stepped in Python"
    return Table(title, {BARE: bare, LEARNING: learn}, [Column("added ns", {LEARNING: BARE}, added_time)])
