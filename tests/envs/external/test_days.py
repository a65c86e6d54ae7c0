"""Libraries of small environments: terminal states without an action, time limits, and files that change."""

import copy
import ctypes
import pickle
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.envs.external import library, trial
from support.native.libraries import SOURCES, capsule_of, compile_c, needs_compiler
from support.parity import assert_same_run
from support.processes.posix import posix_only
from support.processes.timer import stopped_by_a_timer

pytestmark = needs_compiler


def days(folder: Path, **options: object) -> Path:
    given = [f"-D{name}" if value is True else f"-D{name}={value}" for name, value in options.items()]
    return compile_c(SOURCES / "days.c", folder, "days", *given)


@posix_only
def test_a_run_resumes_within_the_planning_after_a_terminal_step(tmp_path: Path) -> None:
    settings: dict[str, Any] = {"algorithm": "dyna_q", "planning_steps": 1_000_000, "action_mask": True, "seed": 0}
    settings["episodes"] = 10**6
    env = qtab.NativeEnv(days(tmp_path))
    stopped = stopped_by_a_timer(0.1, env, **settings)
    some_later = len(stopped.episode_returns) + 2
    resumed = qtab.resume(stopped, env=env, callback=lambda _: False, callback_every=some_later)
    whole = qtab.train(env, callback=lambda _: False, callback_every=some_later, **settings)
    assert_same_run(resumed, whole)


def test_no_step_is_taken_beyond_the_time_limit(tmp_path: Path) -> None:
    file = days(tmp_path, TERMINATES_AT=1000, LIMIT=10)  # the eleventh step would leave the observation space
    run = qtab.train(qtab.NativeEnv(file), episodes=3)
    assert list(run.episode_lengths) == [10, 10, 10]
    with pytest.raises(ValueError, match=r"got 11 as observation\[0\], which has the bounds 0 and 10"):
        qtab.NativeEnv(days(tmp_path, TERMINATES_AT=1000))


def test_python_has_the_time_limit_of_the_capsule(tmp_path: Path) -> None:
    file = days(tmp_path, TERMINATES_AT=1000, LIMIT=10)

    class Days(gym.Env[Any, Any]):
        observation_space = gym.spaces.Discrete(11)
        action_space = gym.spaces.Discrete(2)

        def __qtab_env__(self) -> Any:
            return capsule_of(file)

    with pytest.raises(ValueError, match="max_episode_steps of the environment must be 10, as in its capsule"):
        qtab.train(Days(), episodes=3)


def test_a_step_that_never_ends_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "_SECONDS", 2.0)
    with pytest.raises(ValueError, match="a trial of 100 steps did not end within 2 seconds"):
        qtab.NativeEnv(days(tmp_path, HANGS=True))


def test_a_file_that_cannot_be_copied_and_changes_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    load = ctypes.CDLL

    def load_in_place(path: str) -> Any:
        if not path.startswith(str(tmp_path.resolve())):
            raise OSError("the temporary folder does not allow code")
        return load(path)

    monkeypatch.setattr(ctypes, "CDLL", load_in_place)
    qtab.NativeEnv(days(tmp_path, REWARD="3.0"))
    with pytest.raises(ValueError, match="it was compiled again, and this process still has its earlier version"):
        qtab.NativeEnv(days(tmp_path, REWARD="4.0"))


def test_a_copy_has_the_same_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    days(tmp_path)
    monkeypatch.chdir(tmp_path)
    env = qtab.NativeEnv(f"./{days(tmp_path).name}")
    env.reset(seed=0)
    pickled = pickle.dumps(env)
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    days(tmp_path, REWARD="2.0")
    for copied in (copy.deepcopy(env), pickle.loads(pickled)):  # noqa: S301 - made here
        assert copied.step(0)[1] == 1.0
    monkeypatch.setattr(library, "_loaded", {})  # as in another process
    with pytest.raises(ValueError, match="was compiled again since the environment was copied or pickled"):
        pickle.loads(pickled)  # noqa: S301 - made here


def test_an_action_is_an_integer_of_its_space(tmp_path: Path) -> None:
    env = qtab.NativeEnv(days(tmp_path))
    env.reset(seed=0)
    for action in (-1, 2, 2**70):
        with pytest.raises(IndexError, match=f"action must be from 0 to 1, got {action}"):
            env.step(action)
    with pytest.raises(TypeError):
        env.step(0.5)


def test_the_states_count_towards_the_memory_limit(tmp_path: Path) -> None:
    env = qtab.NativeEnv(days(tmp_path, STATE_SIZE=2**20))
    qtab.train(env, episodes=3, memory_limit=2**22)
    with pytest.raises(MemoryError):
        qtab.train(env, episodes=3, memory_limit=2**21)
