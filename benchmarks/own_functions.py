"""Training on environments of one's own in Python, compiled by Numba, beside the package's and a loop by hand."""

from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np

import qtab
import vector_envs
from loops import numba_loops
from own_cars import SETTINGS, limited, limited_class
from tables import Benchmark, Column, Table, relative_time, relative_to

EPISODES, EPISODES_IN_PYTHON = 5000, 20
ENVPOOL_STEPS = 2_000
"""The steps in a round of EnvPool."""

CORE, NUMBA = "qtab.train on MountainCar-v0", "a loop by hand under numba"
COMPILED, PYTHON = "the same as a FunctionalEnv, compiled", "the FunctionalEnv, stepped in Python"
ORDINARY, ORDINARY_PYTHON = "the same as an ordinary class, compiled", "the ordinary class, stepped in Python"
COMPILED_ONE, COMPILED_TWO = "the FunctionalEnv, 16 seeds, one thread", "the FunctionalEnv, 16 seeds, two threads"
ENVPOOL = "EnvPool's MountainCar, one environment, only stepped"


def training() -> Table:
    """Returns the table of training with the default settings of MountainCar-v0."""
    loops: dict[str, Benchmark] = {CORE: lambda seed: _steps(qtab.train("MountainCar-v0", seed=seed, progress=False))}
    if numba_loops.compiles():
        loops |= {
            COMPILED: lambda seed: _steps(train(limited, seed, "numba", EPISODES)),
            ORDINARY: lambda seed: _steps(train(limited_class, seed, "numba", EPISODES)),
            NUMBA: numba_loops.single_run,
            COMPILED_ONE: lambda _: _many(1),
            COMPILED_TWO: lambda _: _many(2),
        }
    loops[PYTHON] = lambda seed: _steps(train(limited, seed, "python", EPISODES_IN_PYTHON))
    loops[ORDINARY_PYTHON] = lambda seed: _steps(train(limited_class, seed, "python", EPISODES_IN_PYTHON))
    pool = vector_envs.envpool_cars(1, threads=1)
    if pool is not None:
        loops[ENVPOOL] = _stepping(pool)
    of_functions = [name for name in loops if name not in (ORDINARY, ORDINARY_PYTHON)]
    columns = [
        Column(
            "× Python",
            relative_to(PYTHON, of_functions) | {ORDINARY: ORDINARY_PYTHON, ORDINARY_PYTHON: ORDINARY_PYTHON},
        ),
        Column("× numba", relative_to(NUMBA, [CORE, COMPILED, ORDINARY, NUMBA])),
        Column("× one thread", relative_to(COMPILED_ONE, [COMPILED_TWO])),
        Column("rel. to core", relative_to(CORE, [COMPILED, ORDINARY]), relative_time),
    ]
    return Table("Training on an own MountainCar, default settings", loops, columns, minimum=True)


def train(make: Callable[[], gym.Env[Any, Any]], seed: int, backend: Any, episodes: int) -> qtab.Run:
    """Trains on an environment of one's own with the article's settings."""
    return qtab.train(make(), seed=seed, backend=backend, episodes=episodes, **SETTINGS)


def _many(threads: int) -> int:
    return _steps(qtab.train_many(limited, 16, threads=threads, backend="numba", episodes=EPISODES, **SETTINGS))


def _stepping(pool: Any) -> Benchmark:
    actions = list(np.random.default_rng(0).integers(0, 3, (ENVPOOL_STEPS, 1)))
    pool.reset()

    def run(_: int) -> int:
        for action in actions:
            pool.step(action)
        return ENVPOOL_STEPS

    return run


def _steps(run: qtab.Run | qtab.Runs) -> int:
    return int(run.episode_lengths.sum())
