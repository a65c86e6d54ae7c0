"""Runs that are equal to the last bit."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab
from qtab.reference import q_learning


def state_bytes(env: gym.Env) -> bytes:
    """The internal state of an environment as bytes of float64."""
    inner: Any = env.unwrapped
    return np.array(inner.state, dtype=np.float64).tobytes()


def assert_same_run(one: qtab.Run, other: qtab.Run) -> None:
    """Asserts that two runs have the same episodes and the same table."""
    assert one.episode_lengths.tolist() == other.episode_lengths.tolist()
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.terminated.tolist() == other.terminated.tolist()
    assert one.tables.tobytes() == other.tables.tobytes()


def run_of(error: BaseException) -> Any:
    """The run that an error of training carries."""
    return error.run  # type: ignore[attr-defined]


def assert_same_as_reference(run: qtab.Run, env: gym.Env) -> None:
    """Asserts that the reference computes the same run on ``env``, which has the run's time limit."""
    table, returns, lengths = q_learning(env, run.config)
    assert run.episode_lengths.tolist() == lengths.tolist()
    assert run.episode_returns.tobytes() == returns.tobytes()
    assert run.q_table.tobytes() == table.tobytes()


def table_to_go_on_from(seed: int = 0, episodes: int = 5000) -> np.ndarray:
    """A Q table that sometimes reaches MountainCar's goal within 200 steps."""
    return qtab.train("MountainCar-v0", seed=seed, episodes=episodes).q_table


def energy_policy(observation: np.ndarray) -> int:
    """Pushes in the direction of the velocity, which takes the car to the goal."""
    return 2 if observation[1] >= 0 else 0


def assert_same_as_single_runs(runs: qtab.Runs, env: str = "MountainCar-v0", **config: Any) -> None:
    """Asserts that each run of ``train_many`` equals the run of ``train`` with its seed."""
    for index, seed in enumerate(runs.seeds):
        single = qtab.train(env, seed=seed, **config)
        assert runs.episode_returns[index].tobytes() == single.episode_returns.tobytes()
        assert runs.episode_lengths[index].tobytes() == single.episode_lengths.tobytes()
        assert runs.terminated[index].tobytes() == single.terminated.tobytes()
        if runs.tables is not None:
            assert runs.tables[index].tobytes() == single.tables.tobytes()
