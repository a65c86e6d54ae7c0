"""What "equal to the last bit" means, once."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab
from qtab.reference import q_learning


def state_bytes(env: gym.Env) -> bytes:
    """The internal state of a car in f64."""
    inner: Any = env.unwrapped
    return np.array(inner.state, dtype=np.float64).tobytes()


def assert_same_run(one: qtab.Run, other: qtab.Run) -> None:
    """Two runs brought the same episodes and learned the same table."""
    assert one.episode_lengths.tolist() == other.episode_lengths.tolist()
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.terminated.tolist() == other.terminated.tolist()
    assert one.tables.tobytes() == other.tables.tobytes()


def run_of(error: BaseException) -> Any:
    """The run that an error of training carries."""
    return error.run  # type: ignore[attr-defined]


def assert_same_as_reference(run: qtab.Run, env: gym.Env) -> None:
    """A run is what the reference loop computes on ``env``, which has the run's time limit."""
    table, returns, lengths = q_learning(env, run.config)
    assert run.episode_lengths.tolist() == lengths.tolist()
    assert run.episode_returns.tobytes() == returns.tobytes()
    assert run.q_table.tobytes() == table.tobytes()


def table_to_go_on_from(seed: int = 0, episodes: int = 5000) -> np.ndarray:
    """A Q table that reaches MountainCar's goal within the spec's 200 steps now and then."""
    return qtab.train("MountainCar-v0", seed=seed, episodes=episodes).q_table


def energy_policy(observation: np.ndarray) -> int:
    """Pushes the way the car moves, which takes it to the goal."""
    return 2 if observation[1] >= 0 else 0


def assert_same_as_single_runs(runs: qtab.Runs, env: str = "MountainCar-v0", **config: Any) -> None:
    """Each run of ``train_many`` is the run of ``train`` with its seed."""
    for index, seed in enumerate(runs.seeds):
        single = qtab.train(env, seed=seed, **config)
        assert runs.episode_returns[index].tobytes() == single.episode_returns.tobytes()
        assert runs.episode_lengths[index].tobytes() == single.episode_lengths.tobytes()
        assert runs.terminated[index].tobytes() == single.terminated.tobytes()
        if runs.tables is not None:
            assert runs.tables[index].tobytes() == single.tables.tobytes()
