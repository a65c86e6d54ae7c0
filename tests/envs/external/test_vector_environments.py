"""Shared libraries in a vector environment: stepped in Rust, equal to SyncVectorEnv over the same ``NativeEnv``."""

import copy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
from gymnasium.vector import AutoresetMode
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from support.lockstep.own_vectors import in_lockstep, make, same_streams
from support.lockstep.vector import MODES, assert_equal
from support.native.board import Board, board_library
from support.native.libraries import needs_compiler

pytestmark = needs_compiler


class NativeBoard(qtab.NativeEnv):
    """The board of the tests in C."""

    file: Path

    def __init__(self) -> None:
        super().__init__(self.file)


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    NativeBoard.file = board_library(tmp_path_factory.mktemp("board"))
    gym.register("QtabOwn/Board-v0", lambda **_: NativeBoard())
    yield "QtabOwn/Board-v0"
    del gym.registry["QtabOwn/Board-v0"]


@settings(max_examples=12, deadline=None)
@given(
    num_envs=st.integers(1, 5), mode=st.sampled_from(MODES), limit=st.integers(1, 20) | st.none(), seed=st.integers(0)
)
def test_a_library_equals_sync_vector_env(
    board: str, num_envs: int, mode: AutoresetMode, limit: int | None, seed: int
) -> None:
    ours, theirs = make(board, num_envs, mode, max_episode_steps=limit)
    assert ours.is_native
    in_lockstep(ours, theirs, 40, seed)
    same_streams(ours, theirs)


def test_a_library_continues_in_python_and_in_copies(board: str) -> None:
    ours, theirs = make(board, 3)
    in_lockstep(ours, theirs, 7, 5)
    again = copy.deepcopy(ours)
    assert ours.call("_elapsed") == theirs.call("_elapsed")
    for _ in range(30):
        expected = theirs.step([2, 2, 2])
        assert_equal(ours.step([2, 2, 2]), expected)
        assert_equal(again.step([2, 2, 2]), expected)
    assert again.is_native


def test_a_library_that_fails_and_a_class_with_a_capsule(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(NativeBoard, "file", board_library(tmp_path, REWARD=2), raising=False)
    gym.register("QtabOwn/Failing-v0", lambda **_: NativeBoard())
    gym.register("QtabOwn/Capsule-v0", lambda **_: CapsuleBoard())
    try:
        ours = qtab.RustVectorEnv("QtabOwn/Failing-v0", 2)
        places, _ = ours.reset(seed=0)
        for _ in range(int(places[:, 0].min()) + 2):  # to the edge of the board
            ours.step([0, 0])
        with pytest.raises(RuntimeError, match="it returned QTAB_FAILED for action 0"):
            ours.step([0, 0])
        other = qtab.RustVectorEnv("QtabOwn/Capsule-v0", 2)
        assert not other.is_native
        assert "the infos of its class are known to Python only" in caplog.text
        assert other.reset(seed=0)[0].shape == (2, 2)
    finally:
        del gym.registry["QtabOwn/Failing-v0"], gym.registry["QtabOwn/Capsule-v0"]


class CapsuleBoard(Board):
    """A class that gives Rust its functions."""

    def __qtab_env__(self) -> Any:
        raise AssertionError("a vector environment does not use it")
