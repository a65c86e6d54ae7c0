"""``qtab.sb3.VecEnv`` beside one environment after another, without Stable-Baselines3 itself."""

import copy
import subprocess
import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.lockstep import classic_control, toy_text
from support.stable_baselines3 import OneByOne, install

IDS = [*classic_control.IDS, *toy_text.IDS]


@pytest.fixture(autouse=True)
def _stand_in(monkeypatch: pytest.MonkeyPatch) -> None:
    install(monkeypatch)


def same(one: Any, other: Any) -> None:
    """Equal to the last bit in arrays; numbers of infos may be of another type, as 1 and 1.0 are."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for name in one:
            same(one[name], other[name])
    elif isinstance(one, np.ndarray) and one.dtype == object:
        same(one.tolist(), other.tolist())
    elif isinstance(one, list | tuple):
        assert len(one) == len(other)
        for mine, expected in zip(one, other, strict=True):
            same(mine, expected)
    elif isinstance(one, np.ndarray):
        assert (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())
    else:
        assert one == other


def step_both(vector: Any, loop: Any) -> Any:
    actions = np.stack([vector.action_space.sample() for _ in range(vector.num_envs)])
    vector.step_async(actions)
    step = vector.step_wait()
    same(step, loop.step(actions))
    same(vector.reset_infos, loop.reset_infos)
    return step


@pytest.mark.parametrize("name", IDS)
def test_it_steps_as_one_environment_after_another(name):
    vector: Any = qtab.sb3.VecEnv(name, 4, seed=3, max_episode_steps=9)
    loop = OneByOne(name, 4, max_episode_steps=9)
    same(vector.reset(), loop.reset(3))
    same(vector.reset_infos, loop.reset_infos)
    vector.action_space.seed(0)
    ended = 0
    for _ in range(25):
        _, rewards, dones, infos = step_both(vector, loop)
        assert rewards.dtype == np.float32
        assert [bool(done) for done in dones] == ["terminal_observation" in info for info in infos]
        ended += int(dones.sum())
    assert ended >= 8
    assert vector.venv.is_native
    same(vector.reset(), loop.reset(None))  # seeds are used once
    copied = copy.deepcopy(vector)
    actions = np.stack([vector.action_space.sample() for _ in range(4)])
    same(copied.venv.step(actions), vector.venv.step(actions))


@pytest.mark.parametrize("reset_before", [False, True])
def test_options_may_differ_between_sub_environments(reset_before):
    vector: Any = qtab.sb3.VecEnv("MountainCar-v0", 3)
    loop = OneByOne("MountainCar-v0", 3)
    if reset_before:
        vector.seed(5)
        same(vector.reset(), loop.reset(5))
    each = [{"low": -0.5, "high": -0.4}, {}, {"low": 0.0, "high": 0.1}]
    for options in ({"low": -0.2, "high": -0.1}, each):
        vector.seed(7)
        vector.set_options(options)
        same(vector.reset(), loop.reset(7, options if isinstance(options, list) else [options] * 3))
        step_both(vector, loop)
    assert vector.venv.is_native


def test_infos_of_resets_with_options_of_their_own_are_kept():
    vector: Any = qtab.sb3.VecEnv("Taxi-v4", 2)
    loop = OneByOne("Taxi-v4", 2)
    vector.seed(7)
    vector.set_options([{}, {"ignored": 1}])
    same(vector.reset(), loop.reset(7))
    same(vector.reset_infos, loop.reset_infos)


def test_attributes_and_methods_of_sub_environments():
    vector: Any = qtab.sb3.VecEnv("FrozenLake-v1", 3, seed=0)
    assert vector.render_mode is None
    assert vector.metadata == gym.make("FrozenLake-v1").metadata
    assert vector.get_attr("spec")[2].id == "qtab/FrozenLake-v1"
    assert vector.get_attr("action_space", [0, 2]) == [gym.spaces.Discrete(4)] * 2
    assert not vector.has_attr("s")
    assert not vector.has_attr("action_masks")
    assert vector.env_is_wrapped(gym.wrappers.TimeLimit) == [True] * 3
    assert vector.env_is_wrapped(gym.wrappers.ClipReward, 1) == [False]
    vector.reset()
    assert vector.has_attr("np_random")
    assert vector.venv.is_native
    assert vector.get_attr("s") == [0, 0, 0]
    assert not vector.venv.is_native
    vector.set_attr("s", 5, indices=[1])
    assert vector.get_attr("s") == [0, 5, 0]
    assert vector.env_method("get_wrapper_attr", "s", indices=1) == [5]
    with pytest.raises(AttributeError):
        vector.get_attr("action_masks")
    vector.close()


def test_an_assigned_attribute_takes_effect():
    vector: Any = qtab.sb3.VecEnv("Pendulum-v1", 2, seed=0)
    vector.reset()
    vector.set_attr("g", 0.0)
    loop = OneByOne("Pendulum-v1", 2, g=0.0)
    loop.reset(0)
    step_both(vector, loop)


def test_frames():
    vector: Any = qtab.sb3.VecEnv("MountainCar-v0", 2, seed=0, render_mode="rgb_array")
    vector.reset()
    images = vector.get_images()
    assert [image.shape for image in images] == [(400, 600, 3)] * 2
    same(vector.env_method("render", indices=[1]), [images[1]])
    vector.close()
    silent: Any = qtab.sb3.VecEnv("MountainCar-v0", 2)
    with pytest.warns(UserWarning, match="frames need render_mode='rgb_array', got None"):
        assert silent.get_images() == [None, None]


@pytest.mark.parametrize(
    ("kwargs", "error", "match"),
    [
        ({"env": "CartPole"}, ValueError, r"name must be one of .*, got 'CartPole' \(did you mean"),
        ({"env": "Taxi-v4", "num_envs": 0}, ValueError, "num_envs must be"),
        ({"env": "Taxi-v4", "seed": -1}, ValueError, "seed must be"),
        ({"env": "Taxi-v4", "autoreset_mode": "Disabled"}, TypeError, "autoreset_mode must be left out: .* sets it"),
        ({"env": "Taxi-v4", "copy": False}, TypeError, "copy must be left out"),
    ],
)
def test_bad_arguments_are_refused_by_name(kwargs, error, match):
    with pytest.raises(error, match=match):
        qtab.sb3.VecEnv(**kwargs)


def test_without_stable_baselines3_the_error_names_what_to_install():
    code = """
import sys
sys.modules["stable_baselines3"] = None
import qtab
try:
    qtab.sb3.VecEnv
except ModuleNotFoundError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600)
    assert "this needs stable_baselines3" in done.stdout
    assert "which is not installed; run: pip install 'stable-baselines3>=2.9'" in done.stdout


@pytest.mark.parametrize("name", ["MountainCar-v0", "FrozenLake-v1", "Pendulum-v1", "CartPole-v1"])
def test_a_runs_predict_is_what_stable_baselines3_evaluates(name):
    """``evaluate_policy`` calls it with these arguments, and steps with what it returns."""
    run = qtab.train(name, episodes=20, seed=0)
    vector: Any = qtab.sb3.VecEnv(name, 3, seed=5)
    observations, states = vector.reset(), None
    starts = np.ones(3, bool)
    returns = np.zeros(3)
    first: list[float | None] = [None] * 3
    while None in first:
        actions, states = run.predict(observations, state=states, episode_start=starts, deterministic=True)
        vector.step_async(actions)
        observations, rewards, starts, _ = vector.step_wait()
        returns += rewards
        first = [
            float(total) if kept is None and done else kept
            for kept, total, done in zip(first, returns, starts, strict=True)
        ]
    expected = [qtab.evaluate(run, 1, seed=5 + index).returns[0] for index in range(3)]
    assert np.allclose(np.array(first, np.float64), expected, rtol=1e-5)  # rewards are float32
