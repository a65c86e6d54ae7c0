"""Backends: what "auto" chooses, and what "rust" refuses by name."""

import copy
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.classic_control import MountainCarEnv

import qtab
from support.environments import Walk, make_walk
from support.parity import assert_same_run

SHORT: dict[str, Any] = {"seed": 2, "episodes": 6, "max_episode_steps": 25}


@pytest.fixture
def walk_id():
    gym.register("QtabTests/Walk-v0", entry_point=make_walk)
    yield "QtabTests/Walk-v0"
    del gym.registry["QtabTests/Walk-v0"]


@pytest.mark.parametrize("env", ["MountainCar-v0", "qtab/MountainCar-v0", "qtab:qtab/MountainCar-v0"])
def test_auto_uses_rust_for_known_ids(env):
    run = qtab.train(env, **SHORT)
    assert run.config.backend == "rust"
    assert run.config.env == env
    assert_same_run(run, qtab.train("MountainCar-v0", backend="gymnasium", **SHORT))
    assert_same_run(run, qtab.train(env, backend="gymnasium", **SHORT))


def test_auto_uses_rust_for_known_specs():
    run = qtab.train(gym.spec("MountainCar-v0"), **SHORT)
    assert run.config.backend == "rust"
    assert_same_run(run, qtab.train("MountainCar-v0", **SHORT))


def test_a_run_uses_the_time_limit_and_keyword_arguments_of_its_spec():
    spec = copy.deepcopy(gym.spec("MountainCar-v0"))
    spec.max_episode_steps = 40
    spec.kwargs["goal_velocity"] = 0.02
    run = qtab.train(spec, seed=2, episodes=3)
    assert run.config.backend == "rust"
    assert run.config.max_episode_steps == 40
    assert run.config.env_kwargs == {"goal_velocity": 0.02}
    assert (run.episode_lengths == 40).all()
    assert_same_run(run, qtab.train(spec, seed=2, episodes=3, backend="gymnasium"))


def test_a_spec_of_a_wrapped_environment_is_stepped_in_gymnasium_with_its_wrappers():
    spec = gym.wrappers.ClipReward(gym.make("MountainCar-v0"), -0.5, 0.0).spec
    run = qtab.train(spec, **SHORT)
    assert run.config.backend == "gymnasium"
    assert (run.episode_returns == -12.5).all()
    with pytest.raises(ValueError, match="backend must be 'auto' or 'gymnasium' for this environment, got 'rust'"):
        qtab.train(spec, backend="rust", **SHORT)


@pytest.mark.parametrize("env_kwargs", [{"render_mode": "rgb_array"}, {"goal_velocity": np.float32(0.01)}])
def test_auto_uses_gymnasium_for_keyword_arguments_that_rust_does_not_know(env_kwargs):
    run = qtab.train("MountainCar-v0", env_kwargs=env_kwargs, **SHORT)
    assert run.config.backend == "gymnasium"
    with pytest.raises(ValueError, match="backend must be 'auto' or 'gymnasium' for this environment, got 'rust'"):
        qtab.train("MountainCar-v0", env_kwargs=env_kwargs, backend="rust", **SHORT)


def test_auto_uses_rust_for_keyword_arguments_with_default_values():
    run = qtab.train("MountainCar-v0", env_kwargs={"render_mode": None, "goal_velocity": 0}, **SHORT)
    assert run.config.backend == "rust"
    assert_same_run(run, qtab.train("MountainCar-v0", **SHORT))


def test_auto_uses_gymnasium_for_unknown_ids(walk_id):
    run = qtab.train(walk_id, scale=(2, 2), **SHORT)
    assert run.config.backend == "gymnasium"
    with pytest.raises(ValueError, match=r"got 'rust': Rust does not implement Walk"):
        qtab.train(walk_id, scale=(2, 2), backend="rust", **SHORT)


def test_auto_uses_gymnasium_for_a_known_id_that_was_registered_again():
    original = gym.registry["MountainCar-v0"]
    try:
        with pytest.warns(UserWarning, match="Overriding"):
            gym.register("MountainCar-v0", entry_point=make_walk)
        run = qtab.train("MountainCar-v0", scale=(2, 2), **SHORT)
    finally:
        gym.registry["MountainCar-v0"] = original
    assert run.config.backend == "gymnasium"
    assert run.q_table.shape == (9, 9, 3)


def test_an_environment_without_a_limit_trains_with_ten_thousand_steps_recorded(walk_id):
    assert qtab.train(walk_id, scale=(2, 2), episodes=1, seed=0).config.max_episode_steps == 10_000
    assert qtab.train(Walk(), scale=(2, 2), episodes=1, seed=0).config.max_episode_steps == 10_000


@pytest.mark.parametrize("env", ["MountainCar-v0", "qtab/MountainCar-v0"])
def test_rust_replaces_an_unedited_object(env):
    made = gym.make(env, goal_velocity=0.01, max_episode_steps=60)
    run = qtab.train(made, backend="rust", seed=2, episodes=6)
    assert run.config.backend == "rust"
    assert run.config.max_episode_steps == 60
    theirs = gym.make("MountainCar-v0", goal_velocity=0.01, max_episode_steps=60)
    assert_same_run(run, qtab.train(theirs, backend="gymnasium", seed=2, episodes=6))


def test_rust_replaces_an_object_without_wrappers():
    run = qtab.train(gym.make("MountainCar-v0").unwrapped, backend="rust", **SHORT)
    assert_same_run(run, qtab.train("MountainCar-v0", **SHORT))


WRAPPERS = {
    "RecordEpisodeStatistics": gym.wrappers.RecordEpisodeStatistics,
    "TransformReward": lambda env: gym.wrappers.TransformReward(env, lambda reward: 2 * float(reward)),
    "ClipReward": lambda env: gym.wrappers.TimeLimit(gym.wrappers.ClipReward(env, -0.5, 0.0), 10),
}


@pytest.mark.parametrize(("name", "wrap"), WRAPPERS.items(), ids=WRAPPERS)
def test_rust_refuses_a_wrapper_by_name(name, wrap):
    with pytest.raises(ValueError, match=rf"backend must be .*got 'rust': .*wrapper {name}$"):
        qtab.train(wrap(gym.make("MountainCar-v0")), backend="rust", **SHORT)


@pytest.mark.parametrize("env", ["MountainCar-v0", "qtab/MountainCar-v0"])
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("gravity", 0.003),
        ("force", 0.002),
        ("goal_position", 0.4),
        ("goal_velocity", 0.01),
        ("max_speed", 0.05),
        ("min_position", -1.0),
        ("max_position", float("nan")),
        ("gravity", np.float32(0.0025)),
    ],
)
def test_rust_refuses_an_edited_attribute_by_name_and_value(env, name, value):
    made = gym.make(env)
    setattr(made.unwrapped, name, value)
    with pytest.raises(ValueError) as caught:
        qtab.train(made, backend="rust", **SHORT)
    assert f"its attribute {name} was changed from" in str(caught.value)
    assert repr(value) in str(caught.value)


def test_rust_refuses_unknown_environments_and_subclasses_by_name():
    class Steeper(MountainCarEnv):
        pass

    for env, name in ((Walk(), "Walk"), (Steeper(), "Steeper")):
        with pytest.raises(ValueError, match=f"Rust does not implement .*{name}"):
            qtab.train(env, backend="rust", scale=(2, 2), **SHORT)
