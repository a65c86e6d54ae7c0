"""Training and stepping MountainCar-v0."""

import gymnasium as gym
import numpy as np

from qtab.bench import article_c
from qtab.bench.article import q_learning
from qtab.bench.article_numba import compiled, compiled_many
from qtab.bench.timing import Benchmark
from qtab.training.train import train
from qtab.training.train_many import train_many

ENV = "MountainCar-v0"
ARTICLE_EPISODES = 10
"""The episodes of the article's loop in a round; the schedule of the exploration rate is compressed to them."""

STEPS = 20_000
"""The steps in a round of stepping."""

ARTICLE, NUMBA, TRAIN = "the article's loop: NumPy on gymnasium.make", "the same loop under numba", "qtab.train"
MANY, MANY_ON_TWO = "qtab.train_many, 16 seeds, one thread", "qtab.train_many, 32 seeds, two threads"
C = "the same loop in C, -O3 -march=native"
NUMBA_ON_TWO = "the same loop under numba, 32 seeds, two threads"
TRAINING = (ARTICLE, C, NUMBA, NUMBA_ON_TWO, TRAIN, MANY, MANY_ON_TWO)
GYMNASIUM_STEP, QTAB_STEP = "Gymnasium's env.unwrapped.step", "qtab's env.unwrapped.step"
GYMNASIUM_MAKE, QTAB_MAKE = "Gymnasium's env of gymnasium.make", "qtab's env of gymnasium.make"


def training() -> dict[str, Benchmark]:
    """Returns the benchmarks of training: the article's loop, the same in C and numba if they are there, and ours."""

    def article(index: int) -> int:
        _, steps = q_learning(gym.make(ENV), 0.2, 0.9, 0.8, 0.0, ARTICLE_EPISODES, index)
        return steps

    def single(index: int) -> int:
        return int(train(ENV, seed=index, progress=False).episode_lengths.sum())

    def many(seeds: int, threads: int) -> Benchmark:
        return lambda _: int(train_many(ENV, seeds, threads=threads, progress=False).episode_lengths.sum())

    in_c, loop, loops = article_c.compiled(), compiled(), compiled_many(2)
    return {
        ARTICLE: article,
        **({} if in_c is None else {C: in_c}),
        **({} if loop is None else {NUMBA: loop}),
        **({} if loops is None else {NUMBA_ON_TWO: lambda _: loops(32)}),
        TRAIN: single,
        MANY: many(16, 1),
        MANY_ON_TWO: many(32, 2),
    }


def stepping() -> dict[str, Benchmark]:
    """Returns the benchmarks of stepping: without wrappers, and with those of ``gymnasium.make`` and resets."""
    actions: list[int] = np.random.default_rng(0).integers(0, 3, STEPS).tolist()
    return {
        GYMNASIUM_STEP: _unwrapped(ENV, actions),
        QTAB_STEP: _unwrapped(f"qtab/{ENV}", actions),
        GYMNASIUM_MAKE: _wrapped(ENV, actions),
        QTAB_MAKE: _wrapped(f"qtab/{ENV}", actions),
    }


def _unwrapped(name: str, actions: list[int]) -> Benchmark:
    env = gym.make(name).unwrapped

    def run(index: int) -> int:
        env.reset(seed=index)
        step = env.step
        for action in actions:
            step(action)
        return len(actions)

    return run


def _wrapped(name: str, actions: list[int]) -> Benchmark:
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
