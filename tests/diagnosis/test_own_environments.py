"""Runs on environments of a user: functions of a state, ordinary classes, libraries, tables."""

import shutil
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest

import qtab
from support.environments.errand import SETTINGS, Errand, ErrandClass
from support.environments.own import WindyGrid
from support.native.libraries import EXAMPLES, compile_c, needs_compiler

LIMIT = 1000


@pytest.fixture(params=[Errand, ErrandClass])
def errand(request: pytest.FixtureRequest) -> Any:
    """The id of an errand."""
    gym.register("Errand-v0", request.param, max_episode_steps=LIMIT)
    yield "Errand-v0"
    del gym.registry["Errand-v0"]


def check_loop(diagnosis: qtab.Diagnosis) -> None:
    run, evidence = diagnosis.run, diagnosis["greedy loop"].evidence
    assert diagnosis.solved is None
    assert evidence["greedy policy"] == -LIMIT
    assert evidence["last 60 training episodes"] == run.episode_returns.mean()
    assert evidence["last 60 training episodes"] > -200
    assert evidence["share of greedy episodes that repeat states"] == 1.0
    assert evidence["time limit"] == LIMIT
    assert diagnosis["greedy loop"].changes == ({"episodes": 300},)
    count = len(diagnosis.facts.greedy.returns)  # type: ignore[union-attr]
    last = evidence["last 60 training episodes"]
    assert f"Mean returns: -1000 in {count} greedy episodes, {last:.4g} in the last 60 training episodes." in str(
        diagnosis
    )


def test_a_greedy_policy_that_loops_is_found_although_training_reaches_the_goal(errand: str) -> None:
    run = qtab.train(errand, seed=0, episodes=60, **SETTINGS)
    assert qtab.evaluate(run, 1, seed=0).returns.tolist() == [-LIMIT]
    check_loop(qtab.diagnose(run))


def test_the_advised_change_removes_the_loop(errand: str) -> None:
    change = {"episodes": 300}
    diagnosis = qtab.diagnose(qtab.train(errand, seed=0, **{**SETTINGS, **change}))
    assert "greedy loop" in diagnosis.unremarkable
    assert diagnosis.facts.greedy is not None
    assert diagnosis.facts.greedy.returns.tolist() == [-15.0] * 20


def test_an_ordinary_class_in_compiled_code_is_diagnosed(monkeypatch: pytest.MonkeyPatch) -> None:
    numba = pytest.importorskip("numba")
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    monkeypatch.setattr(numba.config, "DISABLE_JIT", 0)
    env = gym.wrappers.TimeLimit(ErrandClass(), LIMIT)
    check_loop(qtab.diagnose(qtab.train(env, seed=0, episodes=60, backend="numba", **SETTINGS), env=env))


@pytest.mark.parametrize("cls", [Errand, ErrandClass])
def test_without_an_id_the_environment_is_an_argument(cls: type[Any]) -> None:
    env = gym.wrappers.TimeLimit(cls(), LIMIT)
    run = qtab.train(env, seed=0, episodes=60, **SETTINGS)
    assert qtab.diagnose(run).reasons["greedy loop"] == "its environment cannot be made again without env="
    check_loop(qtab.diagnose(run, env=env))


def test_a_tabulated_environment_names_the_states_that_repeat() -> None:
    table = qtab.tabulate(gym.wrappers.TimeLimit(Errand(), LIMIT))
    diagnosis = qtab.diagnose(qtab.train(table, seed=0, episodes=60, **SETTINGS), env=table)
    check_loop(diagnosis)
    assert diagnosis.facts.greedy is not None
    [state] = diagnosis.facts.greedy.states
    assert state.removeprefix("state ") in table.state_names
    assert f"visit only 1 state in their second half, for example {state}." in diagnosis["greedy loop"].meaning


def test_a_loop_in_random_wind_is_found() -> None:
    env = gym.wrappers.TimeLimit(WindyGrid(), 200)
    diagnosis = qtab.diagnose(qtab.train(env, seed=0, episodes=300), env=env)
    assert "in their second half, for example state (" in diagnosis["greedy loop"].meaning


def test_a_policy_that_rightly_stays_is_no_loop() -> None:
    # Each step in the left place pays 1, and the right place ends the episode.
    end = [(1.0, 1, 0.0, True)]
    table = qtab.TabularEnv({0: {0: [(1.0, 0, 1.0, False)], 1: end}, 1: {0: end, 1: end}}, [1.0, 0.0])
    run = qtab.train(table, seed=0, episodes=500, max_episode_steps=50, epsilon=0.2, epsilon_schedule="constant")
    diagnosis = qtab.diagnose(run, env=table)
    assert diagnosis.facts.greedy is not None
    assert diagnosis.facts.greedy.repeats.all()
    assert "greedy loop" in diagnosis.unremarkable


@needs_compiler
def test_a_library_is_diagnosed(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES / "own_environment_c", tmp_path / "c")
    [source] = (tmp_path / "c").glob("*.c")
    env = qtab.NativeEnv(compile_c(source, tmp_path))
    run = qtab.train(env, seed=0, episodes=200, discretizer="bins", bins=6, max_episode_steps=50)
    diagnosis = qtab.diagnose(run, env=env)
    assert diagnosis.facts.greedy is not None
    assert len(diagnosis.facts.greedy.returns) == 20


def test_another_environment_is_refused() -> None:
    env = gym.wrappers.TimeLimit(Errand(), LIMIT)
    run = qtab.train(env, seed=0, episodes=60, **SETTINGS)
    with pytest.raises(ValueError, match=r"env must be that of the run, got another one: its attribute cost was 1\.0"):
        qtab.diagnose(run, env=gym.wrappers.TimeLimit(Errand(cost=2.0), LIMIT))
    with pytest.raises(TypeError, match="env must be an Env, got 'Errand-v0'"):
        qtab.diagnose(run, env="Errand-v0")  # type: ignore[arg-type]
