"""Training on an environment of one's own in Python, compiled by Numba, beside the package's and a loop by hand."""

from typing import Any

import gymnasium as gym
import numpy as np

import numba_loops
import qtab
from tables import Benchmark, Column, Table, relative_time, relative_to

STEPS = 200
"""The time limit of an episode."""
SETTINGS: dict[str, Any] = {"scale": (10, 100), "terminal_update": "assign", "progress": False}
"""The settings of the article, which the preset of MountainCar-v0 has."""

CORE, COMPILED = "qtab.train on MountainCar-v0", "the same as a FunctionalEnv, compiled"
PYTHON, NUMBA = "the same, stepped in Python", "a loop by hand under numba"
COMPILED_ONE, COMPILED_TWO = "compiled, 16 seeds, one thread", "compiled, 32 seeds, two threads"


class OwnCar(qtab.FunctionalEnv):
    """MountainCar-v0 as functions of its state, the position and the velocity."""

    observation_space = gym.spaces.Box(np.array([-1.2, -0.07], np.float32), np.array([0.6, 0.07], np.float32))
    action_space = gym.spaces.Discrete(3)

    def __init__(self, force: float = 0.001, gravity: float = 0.0025) -> None:
        self.force, self.gravity = force, gravity

    def initial_state(self, rng: np.random.Generator) -> tuple[float, float]:
        """Returns a position near the bottom, and no velocity."""
        return rng.uniform(low=-0.6, high=-0.4), 0.0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:  # noqa: ARG002 - it does not draw
        """Returns the next state, the reward and whether the goal is reached."""
        position, velocity = state
        velocity += (action - 1) * self.force + np.cos(3 * position) * (-self.gravity)
        velocity = min(max(velocity, -0.07), 0.07)
        position = min(max(position + velocity, -1.2), 0.6)
        if position == -1.2 and velocity < 0:
            velocity = 0.0
        return (position, velocity), -1.0, position >= 0.5 and velocity >= 0.0

    def observe(self, state: Any) -> Any:
        """Returns the state."""
        return state


def limited() -> gym.Env[Any, Any]:
    """Returns the environment with the time limit of MountainCar-v0."""
    return gym.wrappers.TimeLimit(OwnCar(), STEPS)


def training() -> Table:
    """Returns the table of training with the default settings of MountainCar-v0."""
    loops: dict[str, Benchmark] = {CORE: lambda seed: _steps(qtab.train("MountainCar-v0", seed=seed, progress=False))}
    if numba_loops.numba and not numba_loops.numba.config.DISABLE_JIT:
        loops |= {
            COMPILED: lambda seed: _steps(train(seed, "numba", 5000)),
            NUMBA: numba_loops.single_run,
            COMPILED_ONE: lambda _: _many(16, 1),
            COMPILED_TWO: lambda _: _many(32, 2),
        }
    loops[PYTHON] = lambda seed: _steps(train(seed, "python", 20))
    columns = [
        Column("× Python", relative_to(PYTHON, [*loops])),
        Column("× numba", relative_to(NUMBA, [*loops])),
        Column("× one thread", relative_to(COMPILED_ONE, [COMPILED_TWO])),
        Column("rel. to core", relative_to(CORE, [COMPILED]), relative_time),
    ]
    return Table("Training on an own MountainCar, default settings", loops, columns)


def train(seed: int, backend: Any, episodes: int) -> qtab.Run:
    """Trains on the own environment with the article's settings."""
    return qtab.train(limited(), seed=seed, backend=backend, episodes=episodes, **SETTINGS)


def _many(seeds: int, threads: int) -> int:
    runs = qtab.train_many(limited, seeds, threads=threads, backend="numba", episodes=5000, **SETTINGS)
    return int(runs.episode_lengths.sum())


def _steps(run: qtab.Run) -> int:
    return int(run.episode_lengths.sum())
