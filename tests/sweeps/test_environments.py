"""A store notices that the environment of its sweep is another one, or does something else than before."""

import logging
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import RescaleObservation

import qtab
from qtab._utils.versions import versions
from qtab.sweeps import run_versions
from qtab.sweeps.run_records import combined, study_digest, to_text

GRID = {"learning_rate": [0.1, 0.5]}
SHORT: dict[str, Any] = {"seeds": 2, "episodes": 3, "max_episode_steps": 10, "threads": 1, "progress": False}


class Chain(gym.Env[Any, Any]):
    """Two states and a reward; without an id."""

    observation_space = gym.spaces.Discrete(2)
    action_space = gym.spaces.Discrete(2)
    factor = 1.0

    def __init__(self, reward: float = -1.0) -> None:
        self.reward, self.state = reward, 0

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.state = 0
        return 0, {}

    def step(self, action: int) -> Any:
        self.state += 1
        return self.state % 2, self.reward * self.factor, self.state == 4, False, {}


def one() -> Chain:
    return Chain(-1.0)


def other() -> Chain:
    return Chain(-7.0)


@pytest.fixture
def by_id() -> Any:
    made: Any = Chain
    gym.register("QtabTests/Chain-v0", entry_point=made)
    yield "QtabTests/Chain-v0"
    del gym.registry["QtabTests/Chain-v0"]


def test_another_environment_of_the_same_class_is_refused(tmp_path: Path, by_id: str) -> None:
    qtab.sweep(by_id, GRID, store=tmp_path / "a", env_kwargs={"reward": -1.0}, **SHORT)
    with pytest.raises(qtab.StoreError, match="belongs to another sweep"):
        qtab.sweep(by_id, GRID, store=tmp_path / "a", env_kwargs={"reward": -7.0}, **SHORT)


@pytest.mark.slow
def test_another_environment_without_an_id_is_refused(tmp_path: Path) -> None:
    first = qtab.sweep(one, GRID, store=tmp_path / "a", **SHORT)  # in processes
    with pytest.raises(qtab.StoreError, match=r"its attribute reward was -1\.0, and is now -7\.0"):
        qtab.sweep(other, GRID, store=tmp_path / "a", **SHORT)
    again = qtab.sweep(one, GRID, store=tmp_path / "a", **SHORT)
    assert again.columns["final_return"].tolist() == first.columns["final_return"].tolist()


class Trainer:
    """An executor in this process, which needs no other ones."""

    def submit(self, function: Any, *arguments: Any) -> Any:
        from concurrent.futures import Future

        future: Any = Future()
        future.set_result(function(*arguments))
        return future


def swept(store: Path, env: Any) -> qtab.Sweep:
    return qtab.sweep(env, GRID, store=store, executor=Trainer(), **{**SHORT, "threads": None})  # type: ignore[arg-type]


def test_an_environment_whose_rewards_were_changed_is_refused(
    tmp_path: Path, by_id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    swept(tmp_path / "a", by_id)
    monkeypatch.setattr(Chain, "factor", 100.0)
    with pytest.raises(qtab.StoreError, match="has results of an earlier QtabTests/Chain-v0"):
        swept(tmp_path / "a", by_id)


def test_a_store_of_an_earlier_version_loads_and_says_what_it_does_not_know(
    tmp_path: Path, by_id: str, caplog: pytest.LogCaptureFixture
) -> None:
    first = swept(tmp_path / "a", by_id)
    with closing(sqlite3.connect(tmp_path / "a")) as connection, connection:
        meta = dict(connection.execute("SELECT name, value FROM meta").fetchall())
        without = {name: value for name, value in meta.items() if name != "environments"}
        connection.execute("DELETE FROM meta WHERE name = 'environments'")
        changed = combined(int(meta["digest"], 16), [study_digest(meta), study_digest(without)])
        connection.execute("UPDATE meta SET value = ? WHERE name = 'digest'", (to_text(changed),))
    again = swept(tmp_path / "a", by_id)
    assert again.columns["final_return"].tolist() == first.columns["final_return"].tolist()
    assert "stores only the id and the arguments of its environment" in caplog.text


def test_a_store_says_that_its_results_come_from_other_versions(
    tmp_path: Path, by_id: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    swept(tmp_path / "a", by_id)
    monkeypatch.setattr(run_versions, "versions", lambda: {**versions(), "numpy": "9.9.9"})
    with caplog.at_level(logging.WARNING, "qtab"):
        swept(tmp_path / "a", by_id)
    assert f"has results made with numpy {np.__version__}" in caplog.text


def test_a_sweep_from_the_config_of_a_run_is_in_the_environment_of_that_run() -> None:
    env: Any = gym.make("MountainCar-v0", max_episode_steps=10)
    env.unwrapped.goal_position, env.unwrapped.goal_velocity = -1.1, -1.0
    wrapped = RescaleObservation(env, np.float32(0), np.float32(1))
    run = qtab.train(wrapped, discretizer="bins", bins=4, episodes=2, seed=0, progress=False)
    found = qtab.sweep(None, GRID, 1, config=run.config, executor=Trainer(), progress=False)  # type: ignore[arg-type]
    assert found.columns["final_return"].tolist() == [-1.0, -1.0]
