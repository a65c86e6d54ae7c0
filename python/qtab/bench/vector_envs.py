"""Stepping vector environments, and which of them are compared."""

import warnings
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import SyncVectorEnv

from qtab.bench.mountain_car import QTAB_MAKE
from qtab.bench.timing import Benchmark, Timings
from qtab.envs.vector import RustVectorEnv

NUM_ENVS = 4096
CAR, POLE = "MountainCar-v0", "CartPole-v1"

SYNC, QTAB_CARS = "Gymnasium's SyncVectorEnv, 4,096 MountainCars", "qtab's make_vec, 4,096 MountainCars"
ENVPOOL = "EnvPool, 4,096 MountainCars, two threads"
NUMPY_POLES, QTAB_POLES = "Gymnasium's CartPoleVectorEnv, 4,096", "qtab's make_vec, 4,096 CartPoles"
RUST_POLES = "qtab.RustVectorEnv, 4,096 CartPoles"
QTAB_ONE = "qtab's make_vec, 1 MountainCar"

BASES = [("× Gymnasium", (SYNC, NUMPY_POLES)), ("× EnvPool", (ENVPOOL,)), ("× gym.make", (QTAB_MAKE,))]
"""The columns with ratios, each with the benchmarks that others are compared with in it."""
COMPARED = {
    SYNC: (SYNC,),
    ENVPOOL: (SYNC, ENVPOOL),
    QTAB_CARS: (SYNC, ENVPOOL),
    NUMPY_POLES: (NUMPY_POLES,),
    QTAB_POLES: (NUMPY_POLES,),
    RUST_POLES: (NUMPY_POLES,),
    QTAB_ONE: (QTAB_MAKE,),
}
"""The benchmarks that each one is compared with."""


def stepping() -> dict[str, Benchmark]:
    """Returns the benchmarks of stepping with resets; EnvPool's if EnvPool is installed."""
    poles = gym.make_vec(POLE, NUM_ENVS, vectorization_mode="vector_entry_point")
    return {
        SYNC: _steps(SyncVectorEnv([lambda: gym.make(CAR)] * NUM_ENVS), 3, 2),
        **_envpool(),
        QTAB_CARS: _steps(gym.make_vec(f"qtab/{CAR}", NUM_ENVS), 3, 200),
        NUMPY_POLES: _steps(poles, 2, 60),
        QTAB_POLES: _steps(gym.make_vec(f"qtab/{POLE}", NUM_ENVS), 2, 200),
        RUST_POLES: _steps(RustVectorEnv(POLE, NUM_ENVS), 2, 200),
        QTAB_ONE: _steps(gym.make_vec(f"qtab/{CAR}", 1), 3, 10_000),
    }


def compared(timings: Timings) -> list[tuple[str, list[float | None]]]:
    """Returns the timed benchmarks, each with its relative speed in every column of ``BASES``, or None."""
    timed = timings.nanoseconds
    rows = []
    for name in (name for name in COMPARED if name in timed):
        bases = [base for base in COMPARED[name] if base in timed]
        found = [next((base for base in column if base in bases), None) for _, column in BASES]
        rows.append((name, [None if base is None else timings.ratio(base, name) for base in found]))
    return rows


def _envpool() -> dict[str, Benchmark]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Gymnasium warns that its spaces lose precision
        try:
            import envpool
        except ModuleNotFoundError:
            return {}
        pool = envpool.make_gymnasium(CAR, num_envs=NUM_ENVS, num_threads=2)
        return {ENVPOOL: _steps(pool, 3, 5, NUM_ENVS)}


def _steps(env: Any, actions: int, count: int, size: int | None = None) -> Benchmark:
    """Returns the benchmark of ``count`` steps of all sub-environments with random actions drawn in advance."""
    size = env.num_envs if size is None else size
    drawn = list(np.random.default_rng(0).integers(0, actions, (64, size)))
    action_batches = [drawn[index % len(drawn)] for index in range(count)]
    env.reset()

    def run(_: int) -> int:
        step = env.step
        for batch in action_batches:
            step(batch)
        return count * size

    return run
