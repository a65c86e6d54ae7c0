"""Sweeps on wrapped and changed environments: no threshold, and trained again in the same environment or refused."""

from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import RescaleObservation, TransformReward

import qtab
from qtab.plots.parts.inputs import entries
from qtab.rendering.sweep_report import _optimum
from qtab.sweeps.environments import sweep_threshold
from support.parity import assert_same_run

CAR = "MountainCar-v0"
GRID = {"learning_rate": [0.1, 0.5]}
SHORT: dict[str, Any] = {"seeds": 2, "episodes": 3, "discretizer": "bins", "bins": 4, "progress": False}


class Here:
    """An executor in this process."""

    def submit(self, function: Any, *arguments: Any) -> Any:
        future: Any = Future()
        future.set_result(function(*arguments))
        return future


def swept(env: Any, store: Path, **settings: Any) -> tuple[qtab.Sweep, qtab.Sweep]:
    """A sweep, and the same one loaded from its store."""
    executor: Executor = Here()  # type: ignore[assignment]
    arguments: dict[str, Any] = {**SHORT, **settings}
    made = qtab.sweep(env, arguments.pop("grid", GRID), store=store, executor=executor, **arguments)
    return made, qtab.load_sweep(store)


def doubled() -> gym.Env[Any, Any]:
    return TransformReward(gym.make(CAR), lambda reward: 2 * float(reward))


def easy() -> gym.Env[Any, Any]:
    env: Any = gym.make(CAR)
    env.unwrapped.goal_position, env.unwrapped.goal_velocity = -1.1, -1.0
    changed: gym.Env[Any, Any] = env
    return changed


def rescaled() -> gym.Env[Any, Any]:
    return RescaleObservation(easy(), np.float32(0), np.float32(1))


def unchanged() -> gym.Env[Any, Any]:
    return gym.make(CAR)


@pytest.mark.parametrize(("make", "threshold"), [(doubled, None), (easy, None), (unchanged, -110.0), (CAR, -110.0)])
def test_the_threshold_and_the_optimum_are_those_of_the_registered_environment_only(
    tmp_path: Path, make: Any, threshold: float | None
) -> None:
    for table in swept(make, tmp_path / "a.db"):
        assert sweep_threshold(table) == sweep_threshold(table, 1) == threshold
        assert {entry.threshold for entry in entries("table", table, "final returns")[0]} == {threshold}
        if threshold is None:  # the optimum of the registered environment takes seconds
            assert _optimum(table) is None


def test_each_setting_of_a_store_has_its_own_environment(tmp_path: Path) -> None:
    grid = {"env_kwargs": [{"goal_velocity": 0.02}, {}], "learning_rate": [0.1, 0.5]}
    for table in swept(CAR, tmp_path / "a.db", grid=grid):
        assert [sweep_threshold(table, setting) for setting in range(4)] == [None, None, -110.0, -110.0]
        assert sweep_threshold(table) is None
        assert _optimum(table) is None


@pytest.mark.parametrize("make", [easy, rescaled])
def test_the_environment_of_a_loaded_sweep_is_made_again(tmp_path: Path, make: Any) -> None:
    made, loaded = swept(make, tmp_path / "a.db")
    assert loaded.columns["final_return"].max() > -200  # the goal is easy to reach
    assert_same_run(loaded.run(1, 1), made.run(1, 1))
    executor: Executor = Here()  # type: ignore[assignment]
    again = [
        table.confirm(2, env=env, executor=executor) for table, env in ((loaded, None), (made, None), (loaded, make))
    ]
    returns = [found.confirmed.columns["final_return"].tolist() for found in again]
    assert returns[0] == returns[1] == returns[2]
    assert [len(found.confirmed) for found in again] == [2, 2, 2]


def test_an_environment_that_cannot_be_made_again_must_be_given(tmp_path: Path) -> None:
    made, loaded = swept(doubled, tmp_path / "a.db")
    for call in (lambda: loaded.run(0, 0), lambda: loaded.confirm(2)):
        with pytest.raises(ValueError, match=r"env must be given: .*MountainCar-v0 cannot be made .* the function"):
            call()
    assert_same_run(loaded.run(0, 0, env=doubled), made.run(0, 0))


@pytest.mark.parametrize("env", [CAR, easy])
def test_another_environment_than_that_of_the_sweep_is_refused(tmp_path: Path, env: Any) -> None:
    for table in swept(doubled, tmp_path / "a.db"):
        with pytest.raises(ValueError, match=r"env must be that of setting 0 of the sweep, got another one: .*wrapper"):
            table.confirm(2, settings=[0], env=env)
        with pytest.raises(ValueError, match="env must be that of setting 0 of the sweep"):
            table.run(0, 0, env=env)


def test_arguments_of_an_id_keep_their_types(tmp_path: Path) -> None:
    class Sized(gym.Env[Any, Any]):
        """Tells whether its size is a tuple."""

        def __init__(self, size: Any = (1, 1)) -> None:
            self.size = size
            self.observation_space, self.action_space = gym.spaces.Discrete(2), gym.spaces.Discrete(2)

        def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
            super().reset(seed=seed)
            return 0, {}

        def step(self, action: int) -> Any:
            return 1, float(isinstance(self.size, tuple)), True, False, {}

    made: Any = Sized
    gym.register("QtabTests/Sized-v0", entry_point=made)
    try:
        executor: Executor = Here()  # type: ignore[assignment]
        settings: dict[str, Any] = {"episodes": 3, "env_kwargs": {"size": (2, 3)}, "max_episode_steps": 5}
        qtab.sweep("QtabTests/Sized-v0", GRID, 1, store=tmp_path / "a.db", executor=executor, **settings)
        loaded = qtab.load_sweep(tmp_path / "a.db")
        assert loaded.run(0, 0).episode_returns.tolist() == [1.0, 1.0, 1.0]
    finally:
        del gym.registry["QtabTests/Sized-v0"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("UPDATE meta SET value = '[{}]' WHERE name = 'environments'", "digest"),
        ("DELETE FROM meta WHERE name = 'environments'", "digest"),
    ],
)
def test_damaged_descriptions_are_refused(tmp_path: Path, change: str, message: str) -> None:
    from support.files.damage import execute

    swept(CAR, tmp_path / "a.db")
    execute(tmp_path / "a.db", change)
    with pytest.raises(qtab.StoreError, match=message):
        qtab.load_sweep(tmp_path / "a.db")
