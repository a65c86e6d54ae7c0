"""``qtab.NativeEnv`` as a Gymnasium environment."""

import pickle
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.utils.env_checker import check_env

import qtab
from support.native.board import Board, board_library
from support.native.libraries import example_class, needs_compiler

pytestmark = needs_compiler


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return board_library(tmp_path_factory.mktemp("board"))


class Standing(qtab.NativeEnv):
    """The board with the only action that is always allowed."""

    def step(self, action: Any) -> Any:
        return super().step(2)


def test_gymnasium_accepts_it(lander: Path, board: Path) -> None:
    check_env(qtab.NativeEnv(lander), skip_render_check=True)
    check_env(Standing(board), skip_render_check=True)


def test_its_spaces_are_those_of_the_library(lander: Path, board: Path) -> None:
    assert qtab.NativeEnv(lander).observation_space == spaces.Box(
        np.array([0, -30], np.float32), np.array([100, 30], np.float32)
    )
    assert qtab.NativeEnv(lander).action_space == spaces.Discrete(2)
    assert qtab.NativeEnv(board).observation_space == Board.observation_space


@pytest.mark.parametrize("bit_generator", [np.random.PCG64, np.random.MT19937, np.random.Philox])
def test_its_episodes_are_those_of_python(lander: Path, bit_generator: type[np.random.BitGenerator]) -> None:
    ours, theirs = qtab.NativeEnv(lander), example_class("own_environment_c/lander.py", "Lander")()
    for env in (ours, theirs):
        env.np_random = np.random.Generator(bit_generator(5))
    actions = np.random.default_rng(0)
    for _ in range(20):
        assert ours.reset()[0].tobytes() == theirs.reset()[0].tobytes()
        for _ in range(200):
            action = actions.integers(2)
            one, other = ours.step(action), theirs.step(action)
            assert one[0].tobytes() == other[0].tobytes()
            assert (one[1], one[2]) == (other[1], other[2])
            if one[2]:
                break


def test_masks_and_truncation_are_those_of_python(board: Path) -> None:
    ours, theirs = qtab.NativeEnv(board), Board()
    chosen = np.random.default_rng(1)
    for seed in range(30):
        answers: list[Any] = [env.reset(seed=seed) for env in (ours, theirs)]
        is_over = False
        while not is_over:
            masks = [answer[-1]["action_mask"] for answer in answers]
            assert masks[0].dtype == np.int8
            assert masks[0].tolist() == masks[1].tolist()
            action = chosen.choice(np.flatnonzero(masks[0]))
            answers = [env.step(action) for env in (ours, theirs)]
            assert answers[0][0].tolist() == answers[1][0].tolist()
            assert answers[0][1:4] == answers[1][1:4]
            is_over = answers[0][2] or answers[0][3]


def test_the_state_can_be_read_and_set(lander: Path) -> None:
    env, other = qtab.NativeEnv(lander), qtab.NativeEnv(lander)
    with pytest.raises(gym.error.ResetNeeded, match="Cannot read the state before"):
        env.state  # noqa: B018
    env.reset(seed=0)
    other.reset(seed=1)
    env.step(1)
    assert len(env.state) == 16
    other.state = env.state
    assert other.state == env.state
    other.np_random = env.np_random
    generator = env.np_random.bit_generator.state
    one = env.step(0)
    env.np_random.bit_generator.state = generator
    assert other.step(0)[0].tobytes() == one[0].tobytes()
    with pytest.raises(ValueError, match="state must be 16 bytes, got 3"):
        env.state = b"abc"


def test_an_action_that_does_not_exist(lander: Path) -> None:
    env = qtab.NativeEnv(lander)
    with pytest.raises(gym.error.ResetNeeded, match="Cannot step before"):
        env.step(0)
    env.reset(seed=0)
    with pytest.raises(IndexError, match="action must be from 0 to 1, got 2"):
        env.step(2)


def test_the_time_limit_of_the_library_applies(lander: Path) -> None:
    env = qtab.NativeEnv(lander)
    assert env.max_episode_steps == 200
    env.reset(seed=0)
    steps = 0
    while not (answer := env.step(steps % 2))[2] and not answer[3]:
        steps += 1
    assert (steps, answer[3]) == (199, True)


def test_it_can_be_pickled_and_made_by_an_id(lander: Path) -> None:
    env = qtab.NativeEnv(lander)
    env.reset(seed=0)
    env.step(1)
    copied = pickle.loads(pickle.dumps(env))  # noqa: S301 - made here
    assert copied.state == env.state
    assert copied.step(0)[0].tobytes() == env.step(0)[0].tobytes()
    gym.register("own/Lander-v0", entry_point="qtab:NativeEnv", kwargs={"path": str(lander)})
    try:
        made = gym.make("own/Lander-v0")
        assert isinstance(made.unwrapped, qtab.NativeEnv)
        run = qtab.train("own/Lander-v0", discretizer="bins", bins=[4, 4], episodes=5, seed=0)
        assert (run.config.backend, run.config.max_episode_steps) == ("rust", 200)
    finally:
        gym.registry.pop("own/Lander-v0")


def test_the_header_is_in_the_folder_that_is_named() -> None:
    assert (Path(qtab.get_include()) / "qtab_env.h").is_file()
