"""What is timed."""

from collections.abc import Callable

import gymnasium as gym
import numpy as np

from qtab.bench.article import q_learning
from qtab.bench.article_numba import compiled
from qtab.bench.rounds import Subject
from qtab.training.train import train
from qtab.training.train_many import train_many

ENV = "MountainCar-v0"
ARTICLE_EPISODES = 10
"""A round of the slow loop: the whole schedule of the exploration rate in so many episodes."""

STEPS = 20_000
"""Steps in a round of bare stepping."""

ARTICLE, NUMBA, TRAIN = "the article's loop: NumPy on gymnasium.make", "the same loop under numba", "qtab.train"
MANY, MANY_ON_TWO = "qtab.train_many, 16 seeds, one thread", "qtab.train_many, 32 seeds, two threads"
GYMNASIUM_STEP, QTAB_STEP = "Gymnasium's env.unwrapped.step", "qtab's env.unwrapped.step"
GYMNASIUM_MAKE, QTAB_MAKE = "Gymnasium's env of gymnasium.make", "qtab's env of gymnasium.make"


def training() -> dict[str, Subject]:
    """Returns the loops: the article's, numba's where it is installed, and this package's."""

    def article(index: int) -> int:
        _, steps = q_learning(gym.make(ENV), 0.2, 0.9, 0.8, 0.0, ARTICLE_EPISODES, index)
        return steps

    def ours(index: int) -> int:
        return int(train(ENV, seed=index, progress=False).episode_lengths.sum())

    def many(seeds: int, threads: int) -> Subject:
        return lambda _: int(train_many(ENV, seeds, threads=threads).episode_lengths.sum())

    loop = compiled()
    return {
        ARTICLE: article,
        **({} if loop is None else {NUMBA: loop}),
        TRAIN: ours,
        MANY: many(16, 1),
        MANY_ON_TWO: many(32, 2),
    }


def stepping() -> dict[str, Subject]:
    """Returns the environments' steps, bare and as ``gymnasium.make`` wraps them (with its resets)."""
    actions: list[int] = np.random.default_rng(0).integers(0, 3, STEPS).tolist()
    return {
        GYMNASIUM_STEP: _bare(ENV, actions),
        QTAB_STEP: _bare(f"qtab/{ENV}", actions),
        GYMNASIUM_MAKE: _wrapped(ENV, actions),
        QTAB_MAKE: _wrapped(f"qtab/{ENV}", actions),
    }


def _bare(name: str, actions: list[int]) -> Callable[[int], int]:
    env = gym.make(name).unwrapped

    def run(index: int) -> int:
        env.reset(seed=index)
        step = env.step
        for action in actions:
            step(action)
        return len(actions)

    return run


def _wrapped(name: str, actions: list[int]) -> Callable[[int], int]:
    env = gym.make(name)

    def run(index: int) -> int:
        env.reset(seed=index)
        step = env.step
        for action in actions:
            _, _, terminated, truncated, _ = step(action)
            if terminated or truncated:
                env.reset()
        return len(actions)

    return run
