"""Stepping vector environments: Gymnasium's, EnvPool's where it is installed, and qtab's."""

import warnings
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import SyncVectorEnv

import mountain_car
import qtab
from mountain_car import QTAB_MAKE
from tables import Benchmark, Column, Table, relative_to

NUM_ENVS = 4096
CAR, POLE = "MountainCar-v0", "CartPole-v1"

SYNC, QTAB_CARS = "Gymnasium's SyncVectorEnv, 4,096 MountainCars", "qtab's make_vec, 4,096 MountainCars"
ENVPOOL = "EnvPool, 4,096 MountainCars, two threads"
NUMPY_POLES, QTAB_POLES = "Gymnasium's CartPoleVectorEnv, 4,096", "qtab's make_vec, 4,096 CartPoles"
RUST_POLES = "qtab.RustVectorEnv, 4,096 CartPoles"
QTAB_ONE = "qtab's make_vec, 1 MountainCar"

COLUMNS = (
    Column(
        "× Gymnasium",
        relative_to(SYNC, [SYNC, ENVPOOL, QTAB_CARS]) | relative_to(NUMPY_POLES, [NUMPY_POLES, QTAB_POLES, RUST_POLES]),
    ),
    Column("× EnvPool", relative_to(ENVPOOL, [ENVPOOL, QTAB_CARS])),
    Column("× gym.make", {QTAB_ONE: QTAB_MAKE}),
)


def stepping() -> Table:
    """Returns the table of stepping with resets."""
    pool = envpool_cars(NUM_ENVS, threads=2)
    poles = gym.make_vec(POLE, NUM_ENVS, vectorization_mode="vector_entry_point")
    benchmarks = {
        QTAB_MAKE: mountain_car.stepping().benchmarks[QTAB_MAKE],
        SYNC: _steps(SyncVectorEnv([lambda: gym.make(CAR)] * NUM_ENVS), 3, 2),
        **({} if pool is None else {ENVPOOL: _steps(pool, 3, 5)}),
        QTAB_CARS: _steps(gym.make_vec(f"qtab/{CAR}", NUM_ENVS), 3, 200),
        NUMPY_POLES: _steps(poles, 2, 60),
        QTAB_POLES: _steps(gym.make_vec(f"qtab/{POLE}", NUM_ENVS), 2, 200),
        RUST_POLES: _steps(qtab.RustVectorEnv(POLE, NUM_ENVS), 2, 200),
        QTAB_ONE: _steps(gym.make_vec(f"qtab/{CAR}", 1), 3, 10_000),
    }
    return Table("Stepping many sub-environments", benchmarks, COLUMNS)


def envpool_cars(num_envs: int, threads: int) -> Any:
    """Returns EnvPool's MountainCars, or None where it is not installed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Gymnasium warns that its spaces lose precision
        try:
            import envpool
        except ModuleNotFoundError:
            return None
        return envpool.make_gymnasium(CAR, num_envs=num_envs, num_threads=threads)


def _steps(env: Any, actions: int, count: int) -> Benchmark:
    """Returns the benchmark of ``count`` steps of all sub-environments with random actions drawn in advance."""
    size = getattr(env, "num_envs", NUM_ENVS)  # EnvPool's environments have no such attribute
    drawn = list(np.random.default_rng(0).integers(0, actions, (64, size)))
    action_batches = [drawn[index % len(drawn)] for index in range(count)]
    env.reset()

    def run(_: int) -> int:
        step = env.step
        for batch in action_batches:
            step(batch)
        return count * size

    return run
