"""Classes that give Rust a capsule: what happens where a function fails, and what is stepped in Python."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab import _core
from qtab.envs.in_rust.matching import NotInRustError
from support.native.board import SETTINGS, Board, board_library
from support.native.libraries import capsule_of, needs_compiler

pytestmark = needs_compiler


class CompiledBoard(Board):
    """The board in Python, which Rust steps by its capsule."""

    library: Path

    def __qtab_env__(self) -> Any:
        return capsule_of(self.library)


class FailingBoard(CompiledBoard):
    """A board whose function fails, as that in Python does."""

    failures: list[tuple[bytes | None, int | None, float]]

    def __qtab_env_failed__(self, state: bytes | None, action: int | None, rng: np.random.Generator) -> None:
        self.failures.append((state, action, rng.random()))
        raise ZeroDivisionError("the user's error")


@pytest.fixture
def compiled(tmp_path: Path) -> CompiledBoard:
    env = CompiledBoard()
    env.library = board_library(tmp_path)
    return env


def same(ours: Any, theirs: Any) -> bool:
    names = ("episode_returns", "episode_lengths", "terminated", "q_table")
    return all(getattr(ours, name).tobytes() == getattr(theirs, name).tobytes() for name in names)


def test_training_uses_the_capsule_and_its_masks(compiled: CompiledBoard) -> None:
    ours, theirs = qtab.train(compiled, seed=1, **SETTINGS), qtab.train(Board(), seed=1, **SETTINGS)
    assert (ours.config.backend, theirs.config.backend) == ("rust", "gymnasium")
    assert same(ours, theirs)
    assert ours.action_masks is not None
    assert theirs.action_masks is not None
    assert ours.action_masks.tobytes() == theirs.action_masks.tobytes()
    assert not ours.action_masks.all()


def test_masks_of_a_function_need_every_state(compiled: CompiledBoard) -> None:
    def mask(observation: Any) -> Any:
        x, y = observation
        return np.array([x > -2, x < 2, True]) | (x == 2 and y == 5)

    settings = {**SETTINGS, "action_mask": mask}
    ours, theirs = qtab.train(compiled, seed=1, **settings), qtab.train(Board(), seed=1, **settings)
    assert ours.config.backend == "rust"
    assert same(ours, theirs)


@pytest.mark.parametrize("fails_at", [11, 5])
def test_a_failed_step_raises_the_error_of_the_user(tmp_path: Path, fails_at: int) -> None:
    env = FailingBoard()
    env.library, env.failures = board_library(tmp_path, FAILS_AT=fails_at), []
    with pytest.raises(ZeroDivisionError, match="the user's error") as raised:
        qtab.train(env, seed=2, **SETTINGS)
    ((state, action, drawn),) = env.failures
    assert state is not None
    assert np.frombuffer(state, np.int32)[2] == fails_at - 1
    assert action in (0, 1, 2)
    finished = raised.value.run.episode_lengths  # type: ignore[attr-defined]
    replayed = np.random.default_rng(2)
    for length in [*finished, fails_at - 1]:  # resets draw half a word, and steps a word each
        replayed.integers(0, 2**32, dtype=np.uint32)
        replayed.random(length)
    assert drawn == replayed.random()


def test_a_failed_reset_and_a_failure_without_a_handler(tmp_path: Path) -> None:
    env = FailingBoard()
    env.library, env.failures = board_library(tmp_path, RESET_FAILS=True), []
    with pytest.raises(ZeroDivisionError):
        qtab.train(env, seed=0, **SETTINGS)
    assert env.failures == [(None, None, np.random.default_rng(0).random())]
    silent = CompiledBoard()
    silent.library = env.library
    with pytest.raises(RuntimeError, match="reset of the environment failed: it returned QTAB_FAILED"):
        qtab.train(silent, seed=0, **SETTINGS)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"NAN_REWARD": True}, "step must write a finite number as the reward, got NaN"),
        ({"CODE": 4}, "step must return a sum of QTAB_TERMINATED and QTAB_TRUNCATED, or QTAB_FAILED, got 4"),
        ({"BAD_OBSERVATION": 6}, r"observation\[1\] is 6, outside the observation space"),
        ({"NO_ACTION": 3}, r"an action mask of 0 and 1 with at least one 1, got \[0, 0, 0\]"),
    ],
    ids=str,
)
def test_a_lie_in_training_is_an_error(tmp_path: Path, options: dict[str, Any], message: str) -> None:
    env = CompiledBoard()
    env.library = board_library(tmp_path, **options)
    with pytest.raises(ValueError, match=message):
        qtab.train(env, seed=0, **SETTINGS)


def test_what_is_no_capsule(compiled: CompiledBoard, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        TypeError, match=r"__qtab_env__\(\) must return a capsule named 'qtab.env.1', got <class 'int'>"
    ):
        _core.ExternalEnv(1)
    generator: Any = np.random.PCG64(0)
    with pytest.raises(ValueError, match="got one of another name"):
        _core.ExternalEnv(generator.capsule)


def test_a_wrapper_a_replaced_method_and_a_refusal_are_stepped_in_python(
    compiled: CompiledBoard, monkeypatch: pytest.MonkeyPatch
) -> None:
    theirs = qtab.train(Board(), seed=1, **SETTINGS)
    wrapped = gym.wrappers.TransformReward(compiled, lambda reward: reward)
    run = qtab.train(wrapped, seed=1, progress=False, **SETTINGS)
    assert run.config.backend == "gymnasium"
    assert same(run, theirs)
    with pytest.raises(ValueError, match="got 'rust': Rust does not implement its wrapper TransformReward"):
        qtab.train(wrapped, backend="rust", **SETTINGS)

    def refuse(env: Any) -> Any:
        raise NotInRustError("its step calls print, line 7", "remove the call")

    monkeypatch.setattr(CompiledBoard, "__qtab_env__", refuse)
    with pytest.raises(ValueError, match="got 'rust': its step calls print, line 7"):
        qtab.train(compiled, backend="rust", **SETTINGS)
    assert same(qtab.train(compiled, seed=1, progress=False, **SETTINGS), theirs)
    monkeypatch.undo()

    class Overriding(CompiledBoard):
        def step(self, action: Any) -> Any:
            return super().step(action)

    overriding = Overriding()
    overriding.library = compiled.library
    with pytest.raises(ValueError, match="got 'rust': its class Overriding overrides step"):
        qtab.train(overriding, backend="rust", **SETTINGS)
    compiled.step = compiled.step  # type: ignore[method-assign]
    with pytest.raises(ValueError, match="got 'rust': its method step was replaced"):
        qtab.train(compiled, backend="rust", **SETTINGS)
