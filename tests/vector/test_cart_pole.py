"""The vector environment that Gymnasium has for CartPole, beside ours: equal in everything."""

import copy
import pickle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.classic_control.cartpole import CartPoleVectorEnv
from gymnasium.utils.env_checker import data_equivalence
from hypothesis import given
from hypothesis import strategies as st

import qtab  # noqa: F401 - registers them
from support.exact import bitwise

pytestmark = pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date")

ATTRIBUTES = ("state", "steps", "prev_done", "low", "high", "max_episode_steps", "np_random_seed")


def pair(name: str = "CartPole-v1", num_envs: int = 5, **kwargs: Any) -> Any:
    return [gym.make_vec(full, num_envs=num_envs, **kwargs) for full in (f"qtab/{name}", name)]


def step_both(envs: Any, actions: Any) -> Any:
    one, other = (env.step(actions) for env in envs)
    for mine, gymnasiums in zip(one[:4], other[:4], strict=True):
        assert (mine.dtype, mine.shape, mine.strides) == (gymnasiums.dtype, gymnasiums.shape, gymnasiums.strides)
        assert bitwise(mine) == bitwise(gymnasiums)
    assert one[4] == other[4] == {}
    return one


def same_attributes(envs: Any) -> None:
    for name in ATTRIBUTES:
        assert bitwise(getattr(envs[0], name)) == bitwise(getattr(envs[1], name)), name
    assert envs[0].np_random.bit_generator.state == envs[1].np_random.bit_generator.state


@pytest.mark.parametrize(
    ("name", "num_envs", "kwargs"),
    [
        ("CartPole-v1", 1, {"sutton_barto_reward": True}),
        ("CartPole-v1", 19, {}),
        ("CartPole-v0", 4, {}),
        ("CartPole-v1", 33, {"max_episode_steps": 7, "sutton_barto_reward": True}),
    ],
)
def test_steps_equal_gymnasiums(name, num_envs, kwargs):
    envs = pair(name, num_envs, **kwargs)
    one, other = (env.reset(seed=3) for env in envs)
    assert data_equivalence(one, other, exact=True)
    rng = np.random.default_rng(0)
    ended = 0
    for _ in range(250):
        _, _, terminated, truncated, _ = step_both(envs, rng.integers(0, 2, num_envs))
        ended += int((terminated | truncated).sum())
    assert ended > 3
    same_attributes(envs)
    one, other = (env.reset(options={"low": -0.2, "high": 0.1}) for env in envs)
    assert data_equivalence(one, other, exact=True)
    step_both(envs, np.zeros(num_envs, np.int64))
    same_attributes(envs)


def test_it_is_gymnasiums_class_with_steps_in_rust(monkeypatch):
    mine, _ = envs = pair()
    assert isinstance(mine.unwrapped, CartPoleVectorEnv)
    assert repr(mine) == "CartPoleVectorEnv(qtab/CartPole-v1, num_envs=5)"
    assert mine.metadata == envs[1].metadata
    for name in ("observation_space", "action_space", "single_observation_space", "single_action_space"):
        assert getattr(mine, name) == getattr(envs[1], name)
    monkeypatch.setattr(CartPoleVectorEnv, "step", None)
    mine.reset(seed=0)
    assert mine.step(np.ones(5, np.int64))[1].dtype == np.float32


@pytest.mark.parametrize(
    "changes",
    [
        {"gravity": 20.0, "length": 0.8, "force_mag": 3.0},
        {"kinematics_integrator": "semi-implicit"},
        {"gravity": np.float32(9), "tau": 1},
        {"theta_threshold_radians": 0.01, "max_episode_steps": 3, "high": 0.01},
        {"total_mass": 0.0},
        {"_sutton_barto_reward": True},
    ],
    ids=str,
)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_assigned_attributes_take_effect_at_once(changes):
    envs = pair()
    for env in envs:
        env.reset(seed=1)
    for _ in range(3):
        step_both(envs, np.array([0, 1, 0, 1, 1]))
    for env in envs:
        for name, value in changes.items():
            setattr(env, name, value)
    for _ in range(12):
        step_both(envs, np.array([1, 1, 0, 1, 0]))
    same_attributes(envs)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@given(st.lists(st.floats(), min_size=8, max_size=8), st.sampled_from([np.float64, np.float32, ">f8"]))
def test_any_state_steps_as_gymnasium_has_it(numbers, dtype):
    envs = pair(num_envs=2)
    for env in envs:
        env.reset(seed=1)
        env.state = np.array(numbers).astype(dtype).reshape(4, 2)
    for _ in range(2):
        step_both(envs, np.array([1, 0]))


@pytest.mark.parametrize("arrange", [np.asfortranarray, lambda state: np.repeat(state, 2, axis=1)[:, ::2]])
def test_a_state_in_any_memory_order_steps_as_gymnasiums(arrange):
    envs = pair()
    for env in envs:
        env.reset(seed=1)
        env.state = arrange(env.state)
    for _ in range(3):
        step_both(envs, np.array([1, 0, 1, 1, 0]))


@pytest.mark.parametrize("dtype", [np.int64, np.int32, np.uint8, np.int8, bool])
def test_actions_of_any_integer_dtype(dtype):
    envs = pair()
    for env in envs:
        env.reset(seed=1)
    for _ in range(3):
        step_both(envs, np.array([1, 0, 1, 1, 0]).astype(dtype))


@pytest.mark.parametrize("actions", [np.array([0, 1, 2, 0, 0]), np.array([-1] * 5), np.zeros(4, np.int64), None, 1])
def test_invalid_actions_have_gymnasiums_error_and_change_nothing(actions):
    envs = pair()
    before = [copy.deepcopy(env) for env in envs]
    for env in (*envs, *before):
        env.reset(seed=1)
    messages = []
    for env in envs:
        with pytest.raises(AssertionError) as error:
            env.step(actions)
        messages.append(str(error.value))
    assert messages[0] == messages[1]
    same_attributes([envs[0], before[0]])


def test_a_step_before_the_first_reset_has_gymnasiums_error():
    for env in pair():
        with pytest.raises(AssertionError, match="Call reset before using step method"):
            env.step(np.zeros(5, np.int64))


@pytest.mark.parametrize("mode", ["rgb_array", "rgb_array_list"])
def test_frames_are_a_list_as_gymnasiums(mode):
    envs = pair(num_envs=2, render_mode=mode)
    for env in envs:
        env.reset(seed=1)
    for _ in range(2):
        frames, expected = (env.render() for env in envs)
        assert isinstance(frames, list)
        assert data_equivalence(frames, expected, exact=True)
        step_both(envs, np.ones(2, np.int64))
    again = pickle.loads(pickle.dumps(envs[0]))  # noqa: S301
    assert data_equivalence(again.render(), envs[1].render(), exact=True)
    for env in envs:
        env.close()


def test_a_copy_continues_with_the_same_numbers():
    envs = pair(max_episode_steps=20)
    for env in envs:
        env.reset(seed=1)
    for _ in range(15):
        step_both(envs, np.ones(5, np.int64))
    for copied in (copy.deepcopy(envs[0]), pickle.loads(pickle.dumps(envs[0]))):  # noqa: S301
        theirs = copy.deepcopy(envs[1])
        for _ in range(30):
            step_both((copied, theirs), np.ones(5, np.int64))
        same_attributes((copied, theirs))


@pytest.mark.parametrize("name", ["autoreset_mode", "copy", "threads"])
def test_what_gymnasiums_does_not_take_is_refused_with_the_class_that_takes_it(name):
    given: dict[str, Any] = {name: 1}
    with pytest.raises(
        TypeError, match=rf"{name} must be left out, .* got 1; qtab.RustVectorEnv\('CartPole-v1', ...\)"
    ):
        gym.make_vec("qtab/CartPole-v1", num_envs=2, **given)


def test_wrappers_are_refused_as_gymnasium_refuses_them():
    messages = []
    for name in ("qtab/CartPole-v1", "CartPole-v1"):
        for kwargs in ({"wrappers": [gym.wrappers.ClipReward]}, {"vector_kwargs": {"copy": False}}):
            with pytest.raises(gym.error.Error) as error:
                gym.make_vec(name, **kwargs)
            messages.append(str(error.value))
    assert messages[:2] == messages[2:]
