"""Training on MountainCar-v0 with the default settings, and stepping it from Python."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab
from loops import c_loop, numba_loops
from qtab.cli.commands import bench
from tables import Benchmark, Column, Table, relative_to

ENV = "MountainCar-v0"
STEPS = 20_000
"""The steps in a round of stepping."""

C, NUMBA = "the same loop in C, -O3 -march=native", "the same loop under numba"
NUMBA_ON_TWO = "the same loop under numba, 32 seeds, two threads"
MANY, MANY_ON_TWO = "qtab.train_many, 16 seeds, one thread", "qtab.train_many, 32 seeds, two threads"
GYMNASIUM_STEP, QTAB_STEP = "Gymnasium's env.unwrapped.step", "qtab's env.unwrapped.step"
GYMNASIUM_MAKE, QTAB_MAKE = "Gymnasium's env of gymnasium.make", "qtab's env of gymnasium.make"


def training() -> Table:
    """Returns the table of training: the article's loop, the same in C and under Numba if available, and qtab."""
    loops: dict[str, Benchmark] = {bench.ARTICLE: bench.BENCHMARKS[bench.ARTICLE]}
    in_c = c_loop.build()
    if in_c is not None:
        loops[C] = lambda seed: c_loop.train(in_c, seed, numba_loops.EPISODES)[1]
    if numba_loops.numba:
        loops[NUMBA] = numba_loops.single_run
        loops[NUMBA_ON_TWO] = lambda _: numba_loops.many_runs(32, threads=2)
    loops |= {bench.TRAIN: bench.BENCHMARKS[bench.TRAIN], MANY: _many(16, 1), MANY_ON_TWO: _many(32, 2)}
    columns = [
        Column("× article", relative_to(bench.ARTICLE, [*loops])),
        Column("× numba", relative_to(NUMBA, [*loops])),
    ]
    return Table("Training on MountainCar-v0, default settings", loops, columns)


def stepping() -> Table:
    """Returns the table of stepping: without wrappers, and with those of ``gymnasium.make`` and resets."""
    actions: list[int] = np.random.default_rng(0).integers(0, 3, STEPS).tolist()
    loops = {
        GYMNASIUM_STEP: _unwrapped(ENV, actions),
        QTAB_STEP: _unwrapped(f"qtab/{ENV}", actions),
        GYMNASIUM_MAKE: _wrapped(ENV, actions),
        QTAB_MAKE: _wrapped(f"qtab/{ENV}", actions),
    }
    bases = relative_to(GYMNASIUM_STEP, [GYMNASIUM_STEP, QTAB_STEP])
    bases |= relative_to(GYMNASIUM_MAKE, [GYMNASIUM_MAKE, QTAB_MAKE])
    return Table("Stepping MountainCar-v0 from Python", loops, [Column("× Gymnasium", bases)])


def _many(seeds: int, threads: int) -> Benchmark:
    return lambda _: int(qtab.train_many(ENV, seeds, threads=threads, progress=False).episode_lengths.sum())


def _unwrapped(name: str, actions: list[int]) -> Benchmark:
    env: Any = gym.make(name).unwrapped

    def run(index: int) -> int:
        env.reset(seed=index)
        step = env.step
        for action in actions:
            step(action)
        return len(actions)

    return run


def _wrapped(name: str, actions: list[int]) -> Benchmark:
    env: Any = gym.make(name)

    def run(index: int) -> int:
        env.reset(seed=index)
        step = env.step
        for action in actions:
            _, _, terminated, truncated, _ = step(action)
            if terminated or truncated:
                env.reset()
        return len(actions)

    return run
