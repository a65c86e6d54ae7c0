"""Vector environments: what is timed, and its table."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import SyncVectorEnv

from qtab.bench.rounds import Subject, Timings
from qtab.bench.subjects import QTAB_MAKE

NUM_ENVS = 4096
CAR, POLE = "MountainCar-v0", "CartPole-v1"

SYNC = "Gymnasium's SyncVectorEnv, MountainCar × 4,096"
ENVPOOL = "EnvPool, MountainCar × 4,096, two threads"
QTAB_CARS = "qtab's make_vec, MountainCar × 4,096"
NUMPY_POLES = "Gymnasium's CartPoleVectorEnv × 4,096"
QTAB_POLES = "qtab's make_vec, CartPole × 4,096"
QTAB_ONE = "qtab's make_vec, MountainCar × 1"

ROWS = [
    (SYNC, SYNC),
    (SYNC, ENVPOOL),
    (SYNC, QTAB_CARS),
    (ENVPOOL, QTAB_CARS),
    (NUMPY_POLES, NUMPY_POLES),
    (NUMPY_POLES, QTAB_POLES),
    (QTAB_MAKE, QTAB_MAKE),
    (QTAB_MAKE, QTAB_ONE),
]
"""What each row compares: a base, and what may be faster."""


def stepping() -> dict[str, Subject]:
    """Returns the vector environments' steps, their resets included; EnvPool's where it is installed."""
    subjects = {
        SYNC: _steps(SyncVectorEnv([lambda: gym.make(CAR)] * NUM_ENVS), 2),
        QTAB_CARS: _steps(gym.make_vec(f"qtab/{CAR}", NUM_ENVS), 200),
        NUMPY_POLES: _steps(gym.make_vec(POLE, NUM_ENVS, vectorization_mode="vector_entry_point"), 60),
        QTAB_POLES: _steps(gym.make_vec(f"qtab/{POLE}", NUM_ENVS), 60),
        QTAB_ONE: _steps(gym.make_vec(f"qtab/{CAR}", 1), 10_000),
    }
    try:
        import envpool
    except ModuleNotFoundError:
        return subjects
    return subjects | {ENVPOOL: _steps(envpool.make_gymnasium(CAR, num_envs=NUM_ENVS, num_threads=2), 5)}


def lines(timings: Timings) -> list[list[str]]:
    """Returns the rows' names, nanoseconds a sub-environment's step and ratios, of what was timed."""
    rows = [(base, name) for base, name in ROWS if base in timings.nanoseconds and name in timings.nanoseconds]
    return [
        [name, f"{timings.median(name):,.1f}", f"{timings.ratio(base, name):,.1f} × {base}" * (base != name)]
        for base, name in rows
    ]


def _steps(env: Any, count: int) -> Subject:
    """Returns what takes so many steps of all sub-environments, random actions drawn before."""
    env.reset()
    size = getattr(env, "num_envs", NUM_ENVS)
    actions = np.random.default_rng(0).integers(
        0, env.action_space.nvec[0] if hasattr(env.action_space, "nvec") else env.action_space.n, (64, size)
    )

    def run(index: int) -> int:
        step = env.step
        for turn in range(count):
            step(actions[(index + turn) % 64])
        return count * size

    return run
