"""The environments of Sutton & Barto's book: mazes that change, mazes of several sizes, the queue, the racetrack."""

from typing import Any

import gymnasium as gym
import pytest
from gymnasium.utils.env_checker import check_env

import qtab
from qtab.envs.book.mazes import scaled_maze
from qtab.envs.book.racetrack import TRACKS
from support.environments.shortest_path import shortest_path
from support.parity import assert_same_run

IDS = [f"qtab/{name}-v0" for name in ("AccessControlQueue", "BlockingMaze", "DynaMaze", "Racetrack", "ShortcutMaze")]
CHANGING = ["qtab/BlockingMaze-v0", "qtab/ShortcutMaze-v0"]
UP, RIGHT, DOWN, LEFT = range(4)


@pytest.mark.parametrize("env", IDS)
def test_gymnasiums_checker_is_content(env: str) -> None:
    check_env(gym.make(env).unwrapped, skip_render_check=True)


@pytest.mark.parametrize(
    ("env", "kwargs"),
    [
        ("qtab/AccessControlQueue-v0", {"servers": 3, "priorities": (1, 5)}),
        ("qtab/BlockingMaze-v0", {"change_after": 150}),
        ("qtab/ShortcutMaze-v0", {"change_after": 77}),
        ("qtab/DynaMaze-v0", {"doublings": 1}),
        ("qtab/Racetrack-v0", {}),
        ("qtab/Racetrack-v0", {"track": 1, "failure": 0.5}),
    ],
)
@pytest.mark.parametrize("algorithm", ["q_learning", "monte_carlo"])
def test_rust_and_python_give_the_same_run(env: str, kwargs: dict[str, Any], algorithm: Any) -> None:
    settings: dict[str, Any] = {"algorithm": algorithm, "env_kwargs": kwargs, "episodes": 12, "max_episode_steps": 60}
    run = qtab.train(env, seed=3, **settings)
    assert run.config.backend == "rust"
    assert qtab.verify(run).equal
    assert_same_run(qtab.train(env, seed=3, backend="gymnasium", **settings), run)


@pytest.mark.parametrize(("env", "lengths"), [(CHANGING[0], [10, 16]), (CHANGING[1], [16, 10])])
def test_the_mazes_have_the_ways_of_the_book(env: str, lengths: list[int]) -> None:
    made: Any = gym.make(env).unwrapped
    assert [shortest_path(maze) for maze in made.mazes] == lengths
    assert made.change_after == (1000 if env == CHANGING[0] else 3000)


def test_the_change_comes_with_the_step_after_the_last_one_of_the_first_maze() -> None:
    env: Any = gym.make("qtab/BlockingMaze-v0", change_after=3).unwrapped
    env.reset(seed=0)
    below_the_gap = 4 * 9 + 8
    for count in range(5):
        if count == 1:
            env.reset()  # the count goes on
        env.s = below_the_gap
        assert env.step(UP)[0] == (below_the_gap - 9 if count < 3 else below_the_gap)
    env.reset(seed=0)
    env.s = below_the_gap
    assert env.step(UP)[0] == below_the_gap - 9


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
@pytest.mark.parametrize("after", [3, 9])
def test_a_run_is_resumed_before_and_after_the_change(backend: Any, after: int) -> None:
    config: dict[str, Any] = {
        "env_kwargs": {"change_after": 200},
        "algorithm": "dyna_q_plus",
        "episodes": 12,
        "max_episode_steps": 40,
        "seed": 5,
        "backend": backend,
    }
    whole = qtab.train("qtab/BlockingMaze-v0", **config)
    part = qtab.train(
        "qtab/BlockingMaze-v0", **config, callback=lambda progress: progress.episodes < after, callback_every=after
    )
    assert_same_run(qtab.resume(part), whole)


@pytest.mark.parametrize(("doublings", "cells"), list(enumerate([47, 94, 188, 376, 752, 1504, 3008, 6016])))
def test_the_mazes_have_the_sizes_of_the_book(doublings: int, cells: int) -> None:
    layout = scaled_maze(doublings)
    text = "".join(layout)
    assert len(text) - text.count("#") == cells
    assert text.count("S") == 1
    assert text.count("G") == 2**doublings


def test_the_smallest_maze_is_the_dyna_maze() -> None:
    env: Any = gym.make("qtab/DynaMaze-v0").unwrapped
    assert env.P == qtab.book.dyna_maze().P
    assert shortest_path(gym.make("qtab/DynaMaze-v0", doublings=1).unwrapped) > 14


def test_a_customer_is_accepted_if_a_server_is_free() -> None:
    env: Any = gym.make("qtab/AccessControlQueue-v0", servers=2, free_probability=0.25).unwrapped
    reject, accept = 0, 1
    assert {reward for _, _, reward, _ in env.P[4 * 1 + 3][accept]} == {8.0}
    assert {reward for _, _, reward, _ in env.P[4 * 1 + 3][reject]} == {0.0}
    assert {reward for _, _, reward, _ in env.P[4 * 0 + 3][accept]} == {0.0}
    # From one free server, accepting leaves two busy ones: both become free with probability 1/16.
    both = [probability for probability, state, _, _ in env.P[4 * 1 + 3][accept] if state >= 8]
    assert both == [pytest.approx(1 / 64)] * 4
    assert not any(terminated for row in env.P.values() for outcomes in row.values() for *_, terminated in outcomes)
    assert env.initial_state_distrib.tolist() == [0.0] * 8 + [0.25] * 4


def test_the_tracks_are_those_of_the_book() -> None:
    left, right = ("".join(track) for track in TRACKS)
    assert [len(track) for track in TRACKS] == [32, 30]
    assert (left.count("S"), left.count("F")) == (6, 6)
    assert (right.count("S"), right.count("F")) == (23, 9)


def test_a_car_that_leaves_the_track_goes_back_to_the_start() -> None:
    env: Any = gym.make("qtab/Racetrack-v0", failure=0.0).unwrapped
    env.reset(seed=0)
    env.cell, env.velocity = (10, 8), (0, 3)
    state, reward, terminated, truncated, _ = env.step(4)
    assert (env.cell in env.starts, env.velocity, reward, terminated, truncated) == (True, (0, 0), -1.0, False, False)
    assert state == (env.cell[0] * 17 + env.cell[1]) * 25
    env.cell, env.velocity = (2, 14), (0, 4)
    assert env.step(4)[1:3] == (-1.0, True)
    env.cell, env.velocity = (20, 5), (1, 0)
    env.step(1)  # it would stop
    assert (env.cell, env.velocity) == ((19, 5), (1, 0))


@pytest.mark.parametrize(
    ("env", "kwargs", "error", "message"),
    [
        (
            "qtab/BlockingMaze-v0",
            {"change_after": -1},
            ValueError,
            "change_after must be an integer of at least 0, got -1",
        ),
        ("qtab/DynaMaze-v0", {"doublings": 8}, ValueError, "doublings must be an integer from 0 to 7, got 8"),
        ("qtab/Racetrack-v0", {"track": 2}, ValueError, "track must be an integer from 0 to 1, got 2"),
        ("qtab/Racetrack-v0", {"failure": 1.5}, ValueError, "failure must lie in"),
        ("qtab/AccessControlQueue-v0", {"priorities": ()}, ValueError, "priorities must hold the reward"),
        ("qtab/AccessControlQueue-v0", {"servers": 0.5}, TypeError, "servers must be an integer"),
    ],
)
def test_bad_arguments_are_named(env: str, kwargs: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        gym.make(env, **kwargs)
