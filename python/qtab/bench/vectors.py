"""Vector environments: what is timed, and what is compared with what."""

import warnings
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import SyncVectorEnv

from qtab.bench.rounds import Subject, Timings
from qtab.bench.subjects import QTAB_MAKE

NUM_ENVS = 4096
CAR, POLE = "MountainCar-v0", "CartPole-v1"

SYNC, QTAB_CARS = "Gymnasium's SyncVectorEnv, 4,096 MountainCars", "qtab's make_vec, 4,096 MountainCars"
ENVPOOL = "EnvPool, 4,096 MountainCars, two threads"
NUMPY_POLES, QTAB_POLES = "Gymnasium's CartPoleVectorEnv, 4,096", "qtab's make_vec, 4,096 CartPoles"
QTAB_ONE = "qtab's make_vec, 1 MountainCar"

BASES = [("× Gymnasium", (SYNC, NUMPY_POLES)), ("× EnvPool", (ENVPOOL,)), ("× gym.make", (QTAB_MAKE,))]
"""The columns of ratios, and whose nanoseconds are divided there."""
COMPARED = {
    SYNC: (SYNC,),
    ENVPOOL: (SYNC, ENVPOOL),
    QTAB_CARS: (SYNC, ENVPOOL),
    NUMPY_POLES: (NUMPY_POLES,),
    QTAB_POLES: (NUMPY_POLES,),
    QTAB_ONE: (QTAB_MAKE,),
}
"""What each subject is compared with."""


def stepping() -> dict[str, Subject]:
    """Returns the vector environments' steps, their resets included; EnvPool's where it is installed."""
    poles = gym.make_vec(POLE, NUM_ENVS, vectorization_mode="vector_entry_point")
    return {
        SYNC: _steps(SyncVectorEnv([lambda: gym.make(CAR)] * NUM_ENVS), 3, 2),
        **_envpool(),
        QTAB_CARS: _steps(gym.make_vec(f"qtab/{CAR}", NUM_ENVS), 3, 200),
        NUMPY_POLES: _steps(poles, 2, 60),
        QTAB_POLES: _steps(gym.make_vec(f"qtab/{POLE}", NUM_ENVS), 2, 200),
        QTAB_ONE: _steps(gym.make_vec(f"qtab/{CAR}", 1), 3, 10_000),
    }


def compared(timings: Timings) -> list[tuple[str, list[float | None]]]:
    """Returns for each subject that was timed how many times as fast it is, a number or None for each of ``BASES``."""
    timed = timings.nanoseconds
    rows = []
    for name in (name for name in COMPARED if name in timed):
        bases = [base for base in COMPARED[name] if base in timed]
        found = [next((base for base in column if base in bases), None) for _, column in BASES]
        rows.append((name, [None if base is None else timings.ratio(base, name) for base in found]))
    return rows


def _envpool() -> dict[str, Subject]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its spaces lose precision, Gymnasium says
        try:
            import envpool
        except ModuleNotFoundError:
            return {}
        pool = envpool.make_gymnasium(CAR, num_envs=NUM_ENVS, num_threads=2)
        return {ENVPOOL: _steps(pool, 3, 5, NUM_ENVS)}


def _steps(env: Any, actions: int, count: int, size: int | None = None) -> Subject:
    """Returns what takes so many steps of all sub-environments, their actions drawn before."""
    size = env.num_envs if size is None else size
    drawn = list(np.random.default_rng(0).integers(0, actions, (64, size)))
    turns = [drawn[turn % len(drawn)] for turn in range(count)]
    env.reset()

    def run(_: int) -> int:
        step = env.step
        for turn in turns:
            step(turn)
        return count * size

    return run
