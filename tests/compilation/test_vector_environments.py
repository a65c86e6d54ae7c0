"""Ordinary classes in vector environments: compiled, and equal to SyncVectorEnv over the same classes."""

import copy
import logging
import pickle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from support.environments.gym_classes import control, vectors
from support.lockstep.own_vectors import (
    in_lockstep,
    in_lockstep_with_dummy_vec_env,
    make,
    python_continues,
    reset_error_changes_nothing,
    same_streams,
    step_and_reset,
    step_error_changes_nothing,
)
from support.lockstep.vector import MODES, assert_equal

pytest.importorskip("numba")

CLASSES: dict[str, Any] = {
    "Thermostat": control.ThermostatEnv,
    "Drift": vectors.DriftEnv,
    "Lock": vectors.LockEnv,
    "MaskedRow": vectors.MaskedRowEnv,
    "Rooms": vectors.RoomsEnv,
}


@pytest.fixture(scope="module", autouse=True)
def registered(unregistered: None) -> None:
    for name, cls in {**CLASSES, "Fragile": vectors.FragileEnv, "Growing": vectors.GrowingEnv}.items():
        gym.register(f"QtabVec/{name}-v0", cls, vector_entry_point=f"qtab.envs.make_vector:QtabVec/{name}-v0")


@pytest.mark.parametrize("name", CLASSES)
@settings(max_examples=12, deadline=None)
@given(
    num_envs=st.integers(1, 9),
    mode=st.sampled_from(MODES),
    limit=st.integers(1, 12) | st.none(),
    threads=st.none() | st.integers(1, 3),
    copied=st.booleans(),
    seed=st.integers(0, 2**40),
)
def test_compiled_classes_equal_sync_vector_env(
    name: str, num_envs: int, mode: AutoresetMode, limit: int | None, threads: int | None, copied: bool, seed: int
) -> None:
    own = {"threads": threads, "copy": copied, "max_episode_steps": limit}
    ours, theirs = make(f"QtabVec/{name}-v0", num_envs, mode, **own)
    assert ours.is_native
    in_lockstep(ours, theirs, 25, seed)
    assert ours.is_native or name == "Lock"
    same_streams(ours, theirs)
    in_lockstep(ours, theirs, 5, seed + 1)


@pytest.mark.parametrize("mode", MODES)
def test_python_continues_the_episodes(mode: AutoresetMode) -> None:
    same_streams(*python_continues("QtabVec/Drift-v0", mode, 3, lambda env: env.position.tolist()))


def test_envs_of_which_some_were_never_reset_and_attributes_that_are_set() -> None:
    ours, theirs = make("QtabVec/Drift-v0", 3)
    with pytest.raises(gym.error.ResetNeeded):
        ours.step([0, 1, 2])
    assert ours.envs[2].unwrapped.position.tolist() == [0.0, 0.0, 0.0]
    assert_equal(ours.reset(seed=3), theirs.reset(seed=3))
    ours, theirs = make("QtabVec/Drift-v0", 2)
    assert_equal(ours.reset(seed=5), theirs.reset(seed=5))
    for env in (ours, theirs):
        env.step([0, 1])
        env.set_attr("noise", [0.1, 2.0])
    assert_equal(ours.step([1, 2]), theirs.step([1, 2]))


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])  # noqa: S301
def test_copies_continue_with_the_same_numbers(mode: AutoresetMode, copied: Any) -> None:
    ours, theirs = make("QtabVec/Lock-v0", 4, mode, max_episode_steps=9)
    assert_equal(ours.reset(seed=3), theirs.reset(seed=3))
    for row in ([1, 1, -1, 0], [0, 0, 0, 0]):
        assert_equal(ours.step(np.array(row)), theirs.step(np.array(row)))
    again = copied(ours)
    assert again.is_native
    assert again.np_random_seed == ours.np_random_seed
    last = np.array([0, 1, 0, -1])
    assert_equal(again.step(last), ours.step(last))
    assert_equal(again.call("action_masks"), ours.call("action_masks"))  # Python plays both episodes again
    theirs.step(last)
    for _ in range(12):
        step_and_reset(again, theirs, last)


def test_a_copy_of_other_code_is_refused() -> None:
    ours, _ = make("QtabVec/Drift-v0", 2)
    ours.reset(seed=0)
    ours._own.code = "of another class"
    with pytest.raises(ValueError, match="Rust cannot continue the episodes of QtabVec/Drift-v0"):
        copy.copy(ours)


@pytest.mark.parametrize("threads", [1, 3])
def test_the_error_of_a_step_is_that_of_python_and_changes_nothing(threads: int) -> None:
    before = ([0, 1, 0, 1, 0, 1], [1, 0, 0, 0, 1, 0])
    failing = [0, 1, 1, 2, 3, 2]  # compiled code fails in sub-environment 4 as well, where Python does not
    name, message = "QtabVec/Fragile-v0", "the second action"
    raised = step_error_changes_nothing(name, threads, before, failing, [1, 0, 1, 1, 0, 1], message)
    assert any(entry.name == "step" and "vectors.py" in str(entry.path) for entry in raised.traceback)
    _, theirs = make(name, 6)
    theirs.reset(seed=4)
    with pytest.raises(KeyError, match=message):
        [theirs.step(np.array(row)) for row in ([0] * 6, [0] * 6, [2] * 6)]


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_the_error_of_a_reset_is_that_of_python_and_changes_nothing(mode: AutoresetMode) -> None:
    reset_error_changes_nothing("QtabVec/Fragile-v0", mode)


@pytest.mark.parametrize("name", ["Growing", "Fragile"])
@pytest.mark.parametrize("mode", MODES)
def test_a_step_that_fails_in_compiled_code_only_is_taken_in_python(
    name: str, mode: AutoresetMode, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("qtab.compilation.twins.repetition._logged", set())
    ours, theirs = make(f"QtabVec/{name}-v0", 4, mode)
    assert_equal(ours.reset(seed=2), theirs.reset(seed=2))
    rows = [[0, 0, 1, 0], [1, 1, 0, 1], [1, 0, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1], [1, 0, 0, 0], [1, 1, 1, 0]]
    if name == "Fragile":
        rows = [[0, 1, 0, 0], [0, 0, 0, 3], [0, 0, 0, 0]]
    with np.errstate(all="ignore"):
        for row in rows:
            step_and_reset(ours, theirs, np.array(row))
    assert not ours.is_native
    assert f"a vector environment of {name}Env is stepped in Python from now on" in caplog.text
    same_streams(ours, theirs)


def test_options_that_reset_reads_are_given_to_it_in_python(caplog: pytest.LogCaptureFixture) -> None:
    ours, theirs = make("QtabVec/Drift-v0", 2, AutoresetMode.DISABLED)
    assert_equal(ours.reset(seed=0, options={"other": 1}), theirs.reset(seed=0, options={"other": 1}))
    mask = np.array([True, False])
    assert_equal(ours.reset(options={"reset_mask": mask}), theirs.reset(options={"reset_mask": mask}))
    assert ours.is_native  # its reset only passes them on
    ours, theirs = make("QtabVec/Lock-v0", 2)
    assert_equal(ours.reset(seed=0), theirs.reset(seed=0))
    assert ours.is_native
    assert not caplog.text
    for _ in range(2):
        assert_equal(ours.reset(options={"start": 2}), theirs.reset(options={"start": 2}))
    assert not ours.is_native
    assert caplog.text.count("a vector environment of LockEnv is stepped in Python from now on") == 1


def test_stable_baselines3_gets_what_its_own_vector_environment_gives() -> None:
    ours, theirs = in_lockstep_with_dummy_vec_env("QtabVec/Drift-v0")
    with pytest.raises(AttributeError, match="has no attribute 'none'"):
        ours.get_attr("none")
    assert ours.venv.is_native
    assert np.array_equal(ours.get_attr("position"), theirs.get_attr("position"))


@pytest.mark.parametrize(("inner", "outer"), [(4, 20), (20, 4), (4, None), (None, None)])
def test_only_wrappers_limit_the_time_each_of_them(inner: int | None, outer: int | None) -> None:
    class OwnLimit(vectors.DriftEnv):
        def __init__(self) -> None:
            super().__init__()
            self._max_episode_steps = 2  # not a wrapper's

    def made() -> Any:
        return OwnLimit() if inner is None else gym.wrappers.TimeLimit(OwnLimit(), inner)

    name = f"QtabVec/Limit{inner}{outer}-v0"
    entry_point: Any = made  # without keyword arguments
    gym.register(name, entry_point, max_episode_steps=outer)
    ours, theirs = make(name, 3)
    assert ours.is_native
    in_lockstep(ours, theirs, 12, 0)


def test_make_vec_compiles() -> None:
    made: Any = gym.make_vec("QtabVec/Drift-v0", 3, autoreset_mode="SameStep")
    assert isinstance(made, qtab.RustVectorEnv)
    assert made.is_native


def test_without_numba_and_with_a_render_mode(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    with pytest.raises(ValueError, match="and it cannot be compiled: NUMBA_DISABLE_JIT is set"):
        qtab.RustVectorEnv("QtabVec/Drift-v0", 2)


def test_frames_are_drawn_in_python(caplog: pytest.LogCaptureFixture) -> None:
    class Drawn(vectors.DriftEnv):
        metadata = {"render_modes": ["ansi"], "render_fps": 4}  # noqa: RUF012 - Gymnasium's attribute

        def __init__(self, render_mode: str | None = None) -> None:
            super().__init__()
            self.render_mode = render_mode

        def render(self) -> Any:
            return f"at {self.position}"

    gym.register("QtabVec/Drawn-v0", lambda **given: Drawn(**given))
    with caplog.at_level(logging.WARNING, "qtab"):
        ours = qtab.RustVectorEnv("QtabVec/Drawn-v0", 2, render_mode="ansi")
    theirs = SyncVectorEnv([lambda: gym.make("QtabVec/Drawn-v0", render_mode="ansi")] * 2)
    assert_equal(ours.reset(seed=0), theirs.reset(seed=0))
    assert not ours.is_native
    assert ours.render() == theirs.render()
