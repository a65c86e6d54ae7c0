"""What the learner adds to the time of an environment that is stepped in Python."""

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.bench.rounds import Subject, Timings
from qtab.training.train import train

EPISODES, EPISODE_STEPS = 100, 200

BARE, LEARNING = "an idle environment in a bare Python loop", "qtab.train on the idle environment"
Answer = tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]


class Idle(gym.Env[NDArray[np.float32], Any]):
    """Does as little as an environment can: it shows the same two numbers, time and again."""

    observation_space = gym.spaces.Box(0.0, 1.0, (2,), np.float32)
    action_space = gym.spaces.Discrete(3)

    def __init__(self) -> None:
        self._answer: Answer = np.full(2, 0.5, np.float32), -1.0, False, False, {}

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins again where it was."""
        super().reset(seed=seed, options=options)
        return self._answer[0], {}

    def step(self, action: int) -> Answer:  # noqa: ARG002 - it is idle
        """Stays where it is."""
        return self._answer


def python_stepping() -> dict[str, Subject]:
    """Returns the loops over the idle environment: bare, and learning on a grid of ten by ten cells."""
    env = Idle()

    def bare(index: int) -> int:
        step = env.step
        for _ in range(EPISODES):
            env.reset(seed=index)
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
    """Says what learning adds: the median of the differences within each round."""
    added = float(np.median(timings.nanoseconds[LEARNING] - timings.nanoseconds[BARE]))
    return f"learning adds {added:.0f} ns a step to an environment stepped in Python"
