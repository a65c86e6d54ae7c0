"""Rendering equals Gymnasium's, pixel by pixel."""

import gymnasium as gym
import numpy as np
import pytest

import qtab  # noqa: F401 - registers the environment
from support.exact import assert_identical
from support.parity import energy_policy


def pair(render_mode):
    return (
        gym.make("qtab/MountainCar-v0", render_mode=render_mode),
        gym.make("MountainCar-v0", render_mode=render_mode),
    )


def test_pixels_on_the_way_to_the_goal_equal_gymnasiums():
    ours, theirs = pair("rgb_array")
    observation, _ = theirs.reset(seed=0)
    ours.reset(seed=0)
    frames, done = set(), False
    while not done:
        assert_identical(ours.render(), theirs.render())
        frames.add(ours.render().tobytes())
        action = energy_policy(observation)
        ours.step(action)
        observation, _, terminated, truncated, _ = theirs.step(action)
        done = terminated or truncated
    assert terminated
    assert len(frames) > 50
    assert ours.render().shape == (400, 600, 3)
    ours.close()
    theirs.close()


def test_an_assigned_goal_moves_the_flag():
    ours, theirs = pair("rgb_array")
    for env in (ours, theirs):
        env.reset(seed=0)
    before = ours.render()
    for env in (ours, theirs):
        env.unwrapped.goal_position = 0.2
    assert_identical(ours.render(), theirs.render())
    assert not np.array_equal(before, ours.render())
    ours.close()
    theirs.close()


def test_every_step_is_drawn_on_the_screen_in_human_mode(monkeypatch):
    ours, _ = pair("human")
    drawn = []
    env = ours.unwrapped
    render = env.render

    def draw():
        drawn.append(np.array(env.state))
        return render()

    monkeypatch.setattr(env, "render", draw)
    ours.reset(seed=0)
    for _ in range(3):
        ours.step(2)
    assert len(drawn) == 4
    assert env.screen is not None
    assert drawn[-1].tobytes() == np.array(env.state).tobytes()
    ours.close()


def test_no_frames_are_made_without_a_render_mode():
    ours, _ = pair(None)
    ours.reset(seed=0)
    ours.step(0)
    assert ours.unwrapped.screen is None
    with pytest.warns(UserWarning, match=r"qtab/MountainCar-v0"):
        assert ours.unwrapped.render() is None
