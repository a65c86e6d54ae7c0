"""Tables registered by an id: their vector environments step in Rust, equal to SyncVectorEnv."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import SyncVectorEnv

import qtab
from support.environments import Walk
from support.lockstep.vector import assert_equal

LAKE: Any = gym.make("FrozenLake-v1").unwrapped
MAZE = "QtabTests/Maze-v0"


class Maze(qtab.TabularEnv):
    """A subclass with an argument, an attribute and a picture."""

    metadata = {"render_modes": ["ansi"], "render_fps": 4}  # noqa: RUF012 - Gymnasium's way

    def __init__(self, prize: float = 1.0, render_mode: str | None = None) -> None:
        table = {state: {action: list(LAKE.P[state][action]) for action in range(4)} for state in range(16)}
        table[14][2] = [(1.0, 15, prize, True)]
        self.prize, self.render_mode = prize, render_mode
        super().__init__(table, LAKE.initial_state_distrib)

    def render(self) -> Any:
        return f"{self.s} of 16, prize {self.prize}"


@pytest.fixture(autouse=True)
def registered():
    gym.register(
        MAZE, lambda **kwargs: Maze(**kwargs), max_episode_steps=20, vector_entry_point=f"qtab.envs.make_vector:{MAZE}"
    )
    gym.register("QtabTests/PlainWalk-v0", lambda **kwargs: Walk(**kwargs), max_episode_steps=20)
    yield
    del gym.registry[MAZE], gym.registry["QtabTests/PlainWalk-v0"]


def assert_same_steps(ours: Any, theirs: Any, steps: int = 150) -> None:
    actions = np.random.default_rng(0).integers(4, size=(steps, 5))
    assert_equal(ours.reset(seed=3), theirs.reset(seed=3))
    for row in actions:
        assert_equal(ours.step(row), theirs.step(row))


@pytest.mark.parametrize(
    "make",
    [lambda **kwargs: qtab.RustVectorEnv(MAZE, 5, **kwargs), lambda **kwargs: gym.make_vec(MAZE, 5, **kwargs)],
    ids=["RustVectorEnv", "make_vec"],
)
def test_a_registered_table_steps_in_rust_as_sync_vector_env_does(make):
    ours = make(prize=2.5)
    assert ours.is_native
    assert_same_steps(ours, SyncVectorEnv([lambda: gym.make(MAZE, prize=2.5)] * 5))
    assert ours.get_attr("prize") == (2.5,) * 5  # switches to Python, with the states
    assert not ours.is_native


def test_a_table_of_the_book_steps_in_rust_as_sync_vector_env_does():
    ours = qtab.RustVectorEnv("qtab/DynaMaze-v0", 5)
    assert ours.is_native
    assert_same_steps(ours, SyncVectorEnv([lambda: gym.make("qtab/DynaMaze-v0")] * 5))


def test_frames_of_a_users_class_are_drawn_in_python():
    ours = qtab.RustVectorEnv(MAZE, 2, render_mode="ansi")
    assert not ours.is_native
    ours.reset(seed=0)
    assert ours.render() == ("0 of 16, prize 1.0",) * 2


def test_an_environment_that_rust_does_not_step_is_refused_with_the_reason():
    with pytest.raises(ValueError, match=r"^name must be the id of an environment that Rust steps, got 'QtabTests/Pla"):
        qtab.RustVectorEnv("QtabTests/PlainWalk-v0", 2)
