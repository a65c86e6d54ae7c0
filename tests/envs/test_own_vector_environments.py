"""Environments of one's own in a vector environment: stepped in Rust, equal to SyncVectorEnv over the same classes."""

import copy
import logging
import pickle
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from support.environments import own as own_environments
from support.lockstep.own_vectors import (
    in_lockstep,
    in_lockstep_with_dummy_vec_env,
    make,
    python_continues,
    reset_error_changes_nothing,
    same_streams,
    step_error_changes_nothing,
)
from support.lockstep.vector import MODES, assert_equal

pytest.importorskip("numba")

NAMES = ["Elevator", "Gambler", "Inventory", "MineField", "NoisyPendulum", "Queue", "Thermostat", "TicTacToe"]
"""Observations of every kind of space, action masks, and actions that begin at other numbers than 0."""


@pytest.fixture(scope="module", autouse=True)
def numba_compiles() -> Iterator[None]:
    import numba

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_DISABLE_JIT", "0")
        patch.setattr(numba.config, "DISABLE_JIT", 0)
        yield


@pytest.fixture(scope="module", autouse=True)
def registered() -> Iterator[None]:
    ids = {**{name: getattr(own_environments, name) for name in NAMES}, "Countdown": Countdown, "Wide": Wide}
    for name, cls in ids.items():
        gym.register(f"QtabOwn/{name}-v0", cls, vector_entry_point=f"qtab.envs.make_vector:QtabOwn/{name}-v0")
    yield
    for name in ids:
        del gym.registry[f"QtabOwn/{name}-v0"]


class Countdown(qtab.FunctionalEnv):
    """Counts down from a random number to 0. The action is subtracted; 3 fails, and so do resets that draw a number."""

    observation_space = spaces.Box(-10.0, 10.0, (1,))
    action_space = spaces.Discrete(4)

    def __init__(self, unlucky: float = -1.0, render_mode: str | None = None) -> None:
        self.unlucky = unlucky

    def initial_state(self, rng: np.random.Generator) -> Any:
        chance = rng.random()
        if chance == self.unlucky:
            raise ValueError("no first state")
        return 3 + int(6 * chance)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        if action == 3:
            raise KeyError("the third action")
        following = state - action - (1 if rng.random() < 0.5 else 0)
        return following, float(state), following <= 0

    def observe(self, state: Any) -> Any:
        return float(state)


class Wide(qtab.FunctionalEnv):
    """Its actions are vectors, which cannot be compiled."""

    observation_space = spaces.Discrete(4)
    action_space = spaces.MultiDiscrete([2, 3])

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0

    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> Any:
        following = (state + int(action[0]) + int(rng.integers(0, 2))) % 4
        return following, float(action[1]), following == 3

    def observe(self, state: Any) -> Any:
        return state


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=12, deadline=None)
@given(
    num_envs=st.integers(1, 9),
    mode=st.sampled_from(MODES),
    limit=st.integers(1, 12) | st.none(),
    threads=st.none() | st.integers(1, 3),
    copied=st.booleans(),
    seed=st.integers(0, 2**40),
)
def test_compiled_environments_equal_sync_vector_env(
    name: str, num_envs: int, mode: AutoresetMode, limit: int | None, threads: int | None, copied: bool, seed: int
) -> None:
    own = {"threads": threads, "copy": copied, "max_episode_steps": limit}
    ours, theirs = make(f"QtabOwn/{name}-v0", num_envs, mode, **own)
    assert ours.is_native
    in_lockstep(ours, theirs, 25, seed)
    assert ours.is_native
    same_streams(ours, theirs)
    in_lockstep(ours, theirs, 5, seed + 1)


@pytest.mark.parametrize("mode", MODES)
def test_python_continues_the_episodes(mode: AutoresetMode) -> None:
    python_continues("QtabOwn/Countdown-v0", mode, 2, lambda env: env.state)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])  # noqa: S301
def test_copies_continue_with_the_same_numbers(mode: AutoresetMode, copied: Any) -> None:
    ours = make("QtabOwn/Gambler-v0", 4, mode, max_episode_steps=9)[0]
    untouched = copied(ours)
    assert_equal(untouched.reset(seed=3), ours.reset(seed=3))
    for _ in range(8):
        ours.reset(seed=3)
        ours.step(np.array([1, 1, 2, 1]))
        again = copied(ours)
        assert again.is_native
        assert_equal(again.step(np.array([1, 1, 1, 2])), ours.step(np.array([1, 1, 1, 2])))
        assert again.np_random_seed == ours.np_random_seed


@pytest.mark.parametrize("threads", [1, 3])
def test_the_error_of_a_step_is_that_of_python_and_changes_nothing(threads: int) -> None:
    name, message, failing = "QtabOwn/Countdown-v0", "the third action", [0, 1, 1, 3, 0, 3]
    raised = step_error_changes_nothing(name, threads, [[0, 1, 0, 1, 0, 1]], failing, [1, 0, 2, 1, 0, 1], message)
    assert any("transition" in str(entry) for entry in raised.traceback)
    _, theirs = make(name, 6)
    theirs.reset(seed=4)
    with pytest.raises(KeyError, match=message):
        theirs.step(failing)


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_the_error_of_a_reset_is_that_of_python_and_changes_nothing(mode: AutoresetMode) -> None:
    reset_error_changes_nothing("QtabOwn/Countdown-v0", mode)


def test_a_state_of_the_options_and_the_number_of_an_action() -> None:
    ours, theirs = make("QtabOwn/Countdown-v0", 2)
    assert_equal(ours.reset(seed=0), theirs.reset(seed=0))
    assert_equal(ours.reset(options={"other": 1}), theirs.reset(options={"other": 1}))
    with pytest.raises(AssertionError, match=r"sub-environment 1: 4 \(<class 'int'>\) invalid"):
        ours.step([0, 4])
    with pytest.raises(ValueError, match=r"actions must have shape \(2,\), got 3 of them"):
        ours.step([0, 1, 2])
    assert ours.is_native
    assert_equal(ours.reset(options={"state": 5}), theirs.reset(options={"state": 5}))
    assert not ours.is_native
    gambler, _ = make("QtabOwn/Gambler-v0", 1)
    gambler.reset(seed=0)
    for action in (0, 51, -1):
        with pytest.raises(AssertionError, match=f"sub-environment 0: {action} "):
            gambler.step([action])
        with pytest.raises(AssertionError, match=r"sub-environment 0: .* invalid"):
            gambler.step(np.array([action]))


def test_stable_baselines3_gets_what_its_own_vector_environment_gives() -> None:
    in_lockstep_with_dummy_vec_env("QtabOwn/Countdown-v0")


def test_make_vec_steps_in_rust() -> None:
    made: Any = gym.make_vec("QtabOwn/Countdown-v0", 3, autoreset_mode="SameStep")
    assert isinstance(made, qtab.RustVectorEnv)
    assert made.is_native
    assert made.autoreset_mode is AutoresetMode.SAME_STEP


def test_what_cannot_be_compiled_is_stepped_in_python(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "qtab"):
        ours, theirs = make("QtabOwn/Wide-v0", 4, max_episode_steps=5)
    assert "QtabOwn/Wide-v0 is stepped in Python" in caplog.text
    assert "the action space is not Discrete" in caplog.text
    assert not ours.is_native
    assert_equal(ours.reset(seed=2), theirs.reset(seed=2))
    for row in np.random.default_rng(1).integers(0, 2, (30, 4, 2)):
        assert_equal(ours.step(row), theirs.step(row))
    again = copy.deepcopy(ours)
    assert_equal(again.step(np.zeros((4, 2), int)), ours.step(np.zeros((4, 2), int)))


def test_without_numba_python_steps(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    ours, theirs = make("QtabOwn/Countdown-v0", 2)
    assert not ours.is_native
    assert "is stepped in Python, which is much slower than Rust: NUMBA_DISABLE_JIT is set" in caplog.text
    assert_equal(ours.reset(seed=0), theirs.reset(seed=0))
    for action in (0, 1, 2, 2, 1):
        assert_equal(ours.step([action] * 2), theirs.step([action] * 2))


def test_frames_of_a_class_are_drawn_in_python() -> None:
    class Drawn(Countdown):
        metadata = {"render_modes": ["ansi"], "render_fps": 4}  # noqa: RUF012 - Gymnasium's attribute

        def __init__(self, render_mode: str | None = None) -> None:
            super().__init__()
            self.render_mode = render_mode

        def render(self, state: Any) -> Any:  # type: ignore[override]
            return f"at {state}"

    gym.register("QtabOwn/Drawn-v0", lambda **given: Drawn(**given))
    try:
        ours = qtab.RustVectorEnv("QtabOwn/Drawn-v0", 2, render_mode="ansi")
        ours.reset(seed=0)
        assert not ours.is_native
        assert all(frame.startswith("at ") for frame in ours.render())
    finally:
        del gym.registry["QtabOwn/Drawn-v0"]
