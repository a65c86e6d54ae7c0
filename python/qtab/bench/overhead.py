"""The time that learning adds to an environment that is stepped in Python."""

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.bench.timing import Benchmark, Timings
from qtab.training.train import train

EPISODES, EPISODE_STEPS = 100, 200

BARE, LEARNING = "an idle environment in a bare Python loop", "qtab.train on the idle environment"
Step = tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]


class IdleEnv(gym.Env[NDArray[np.float32], Any]):
    """An environment that does as little as possible: every step returns the same observation and a reward of -1."""

    observation_space = gym.spaces.Box(0.0, 1.0, (2,), np.float32)
    action_space = gym.spaces.Discrete(3)

    def __init__(self) -> None:
        self._step: Step = np.full(2, 0.5, np.float32), -1.0, False, False, {}

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Returns the observation."""
        super().reset(seed=seed, options=options)
        return self._step[0], {}

    def step(self, action: int) -> Step:  # noqa: ARG002 - it has no effect
        """Returns the observation, a reward of -1, and flags that are False."""
        return self._step


def python_stepping() -> dict[str, Benchmark]:
    """Returns the benchmarks on the idle environment: stepping only, and learning on a grid of 10 x 10 cells."""
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

    def learning(index: int) -> int:
        run = train(env, episodes=EPISODES, max_episode_steps=EPISODE_STEPS, scale=(10, 10), seed=index, progress=False)
        return int(run.episode_lengths.sum())

    return {BARE: bare, LEARNING: learning}


def sentence(timings: Timings) -> str:
    """Returns the time that learning adds, the median over the rounds of the differences, as a sentence."""
    added = float(np.median(timings.nanoseconds[LEARNING] - timings.nanoseconds[BARE]))
    return f"learning adds {added:.0f} ns per step to an environment stepped in Python"
