"""Errors of vector environments: their messages, and that they change no state."""

import copy
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence

from support.lockstep import classic_control, toy_text
from support.lockstep.vector import IDS, ours, position

pytestmark = pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date")
DISCRETE = ["MountainCar-v0", "CartPole-v1", "Acrobot-v1", *toy_text.IDS]


def standing(env: Any) -> Any:
    return copy.deepcopy(env.snapshots()), [position(generator) for generator in env.np_random]


def refused(env: Any, call: Any, error: type[Exception], match: str) -> None:
    """Asserts that a call raises and changes nothing: the environment continues like an untouched one."""
    before = standing(env)
    with pytest.raises(error, match=match):
        call(env)
    assert data_equivalence(standing(env), before, exact=True)


BAD_ACTIONS = [
    (np.array([0, 1, 7]), AssertionError, r"sub-environment 2: np.int64\(7\) \(<class 'numpy.int64'>\) invalid"),
    (np.array([0, -1, 0]), AssertionError, r"sub-environment 1: np.int64\(-1\)"),
    (np.array([0, 1, 255], np.uint8), AssertionError, r"sub-environment 2: np.uint8\(255\)"),
    (np.array([0, 1, 2**63], np.uint64), AssertionError, "sub-environment 2"),
    (np.array([0.0, 1.0, 1.0]), AssertionError, r"sub-environment [01]: np.float64"),
    (np.array([0.0, np.nan, 1.0], np.float32), AssertionError, r"sub-environment [01]: np.float32"),
    (np.array([True, False, True]), AssertionError, r"sub-environment [01]: np.(True|False)_"),
    (np.array([0, 1, None], object), AssertionError, "sub-environment 2: None"),
    ([0, 1, "left"], AssertionError, "sub-environment 2: 'left'"),
    ([0, 1, 1.0], AssertionError, "sub-environment 2: 1.0"),
    (np.array([0, 1]), ValueError, r"actions must have shape \(3,\), got \(2,\)"),
    (np.zeros((3, 1), np.int64), ValueError, r"actions must have shape \(3,\), got \(3, 1\)"),
    (np.int64(1), TypeError, r"actions must be an array of shape \(3,\), got np.int64\(1\)"),
    (1, TypeError, r"actions must be an array of shape \(3,\), got 1"),
    (None, TypeError, "actions must be an array"),
    ([0, 1], ValueError, r"actions must have shape \(3,\), got 2 of them"),
    ([0, 1, 1, 0], ValueError, r"actions must have shape \(3,\), got 4 of them"),
    ([], ValueError, "got 0 of them"),
]


@pytest.mark.parametrize(("actions", "error", "match"), BAD_ACTIONS)
@pytest.mark.parametrize("name", DISCRETE)
def test_bad_actions_change_no_state(name, actions, error, match):
    env = ours(name, 3)
    env.reset(seed=1)
    env.step(np.array([0, 1, 1]))
    refused(env, lambda env: env.step(actions), error, match)
    env.step([0, 1, np.int64(1)])


@pytest.mark.parametrize("name", ["CartPole-v1", "Taxi-v4"])
def test_bad_actions_change_no_state_in_python(name):
    env = ours(name, 3, autoreset_mode="Disabled", max_episode_steps=3)
    env.reset(seed=1)
    env.step(np.zeros(3, np.int64))
    sub_environments = env.envs
    for actions, error in ((np.array([0, 1, 9]), AssertionError), ([0, 1], ValueError), ([0, 1, 0.5], AssertionError)):
        before = [copy.copy(sub.unwrapped.__dict__) for sub in sub_environments]
        with pytest.raises(error, match=r"sub-environment 2|actions must have shape \(3,\), got 2 of them"):
            env.step(actions)
        assert data_equivalence(before, [copy.copy(sub.unwrapped.__dict__) for sub in sub_environments], exact=True)
    env.step(np.zeros(3, np.int64))
    env.step(np.zeros(3, np.int64))
    with pytest.raises(AssertionError, match="episode of sub-environment 0 is over: reset it first"):
        env.step(np.zeros(3, np.int64))
    forces = ours("Pendulum-v1", 2)
    forces.reset(seed=1)
    states = forces.get_attr("state")
    with pytest.raises(ValueError, match=r"actions\[1\] must be a finite number"):
        forces.step(np.array([[0.5], [np.nan]], np.float32))
    assert forces.get_attr("state") == states


BAD_FORCES = [
    (np.array([[0.5], [np.nan], [0.0]], np.float32), ValueError, r"actions\[1\] must be a finite number, got NaN"),
    (np.array([[0.5], [0.5], [-np.inf]]), ValueError, r"actions\[2\] must be a finite number, got -inf"),
    (np.array([[0.5], [0.5], [1e200]]), ValueError, r"actions\[2\] must be a finite number"),
    (np.zeros(3, np.float32), ValueError, r"actions must have shape \(3, 1\), got \(3,\)"),
    (np.zeros((3, 2), np.float32), ValueError, r"actions must have shape \(3, 1\), got \(3, 2\)"),
    (np.zeros((2, 1), np.float32), ValueError, r"actions must have shape \(3, 1\), got \(2, 1\)"),
    (np.zeros((3, 1), np.float16), TypeError, "actions must have dtype float32 or float64, got float16"),
    (np.zeros((3, 1), np.complex64), TypeError, "got complex64"),
    (np.zeros((3, 1), bool), TypeError, "got bool"),
    (np.full((3, 1), None), TypeError, "got object"),
    ([[0.5], [0.5], ["much"]], TypeError, r"actions\[2\] must hold one number, got \['much'\]"),
    ([[0.5], [0.5], [0.5, 1.0]], TypeError, r"actions\[2\] must hold one number"),
    ([0.5, 0.5, 0.5], TypeError, r"actions\[0\] must hold one number, got 0.5"),
    ([[0.5], [0.5]], ValueError, "got 2 of them"),
    (0.5, TypeError, "actions must be an array of shape"),
]


@pytest.mark.parametrize(("actions", "error", "match"), BAD_FORCES)
@pytest.mark.parametrize("name", classic_control.CONTINUOUS)
def test_bad_forces_change_no_state(name, actions, error, match):
    env = ours(name, 3)
    env.reset(seed=1)
    env.step(np.zeros((3, 1), np.float32))
    refused(env, lambda env: env.step(actions), error, match)


@pytest.mark.parametrize("name", classic_control.CONTINUOUS)
def test_forces_that_gymnasium_accepts_are_accepted(name):
    from support.lockstep.vector import LockstepVectorEnv

    vectors = LockstepVectorEnv(name, 3)
    vectors.reset(seed=1)
    for actions in (
        np.array([[1], [0], [-3]]),
        np.array([[1], [0], [3]], np.uint8),
        [[0.25], [1], [-7.5]],
        [[0.3]] * 3,
        [np.array([0.3], np.float32)] * 3,
        (np.array([0.3]), [-0.5], np.array([2.5], np.float32)),
        np.array([[0.5, 9], [0.1, 9], [0.2, 9]], np.float32)[:, :1],
        np.asfortranarray(np.linspace(-1, 1, 6).reshape(3, 2))[:, 1:],
    ):
        vectors.step(actions)


@pytest.mark.parametrize("name", IDS)
def test_actions_of_finished_sub_environments_are_ignored(name):
    env = ours(name, 3, max_episode_steps=1)
    env.reset(seed=0)
    good = np.zeros((3, 1), np.float32) if name in classic_control.CONTINUOUS else np.zeros(3, np.int64)
    env.step(good)
    assert env.step(np.full_like(good, -99))[1].tolist() == [0.0, 0.0, 0.0]
    if name not in classic_control.CONTINUOUS:
        with pytest.raises(AssertionError, match="sub-environment 0"):
            env.step(np.full_like(good, -99))


@pytest.mark.parametrize("name", IDS)
def test_a_step_before_a_reset_is_refused(name):
    env = ours(name, 3)
    with pytest.raises(gym.error.ResetNeeded, match="sub-environment 0"):
        env.step(env.action_space.sample())
    with pytest.raises(gym.error.ResetNeeded, match="leave out sub-environment 0, which was never reset"):
        env.reset(options={"reset_mask": np.array([False, True, True])})
    with pytest.raises(gym.error.ResetNeeded):
        env.step(env.action_space.sample())


NO_MASK = "`options\\['reset_mask'\\]` must "
BAD_RESETS = [
    ({"seed": -1}, gym.error.Error, "sub-environment 0: Seed must be greater or equal to zero, actual value: -1"),
    ({"seed": [1, 2, -5]}, gym.error.Error, "sub-environment 2: Seed must be greater"),
    ({"seed": [1, np.int64(2), 5]}, gym.error.Error, "sub-environment 1: Seed must be a python integer, actual type"),
    ({"seed": [1, 2.5, 5]}, gym.error.Error, "sub-environment 1: Seed must be a python integer"),
    ({"seed": [1, 2]}, ValueError, "the length must match num_envs=3 but got length=2"),
    ({"seed": []}, ValueError, "got length=0"),
    ({"seed": 1.5}, TypeError, "seed must be an integer, a list of integers or None, got 1.5"),
    ({"seed": np.int64(3)}, TypeError, "seed must be an integer"),
    ({"seed": "3"}, TypeError, "seed must be an integer"),
    ({"seed": 3, "options": {"reset_mask": [True, False, True]}}, TypeError, NO_MASK + "be a numpy array"),
    ({"seed": 3, "options": {"reset_mask": np.ones(2, bool)}}, ValueError, NO_MASK + r"have shape `\(3,\)`"),
    ({"seed": 3, "options": {"reset_mask": np.ones(3)}}, TypeError, NO_MASK + "have `dtype=np.bool_`"),
    ({"seed": 3, "options": {"reset_mask": np.zeros(3, bool)}}, ValueError, "at least one True"),
]


@pytest.mark.parametrize(("arguments", "error", "match"), BAD_RESETS)
@pytest.mark.parametrize("name", ["CartPole-v1", "Taxi-v4"])
def test_bad_resets_change_nothing(name, arguments, error, match):
    env = ours(name, 3)
    env.reset(seed=1)
    refused(env, lambda env: env.reset(**arguments), error, match)
    env.envs  # noqa: B018 - from now on in Python
    with pytest.raises(error, match=match):
        env.reset(**arguments)


@pytest.mark.parametrize(
    ("name", "options", "error"),
    [
        ("CartPole-v1", {"low": 1, "high": -1}, ValueError),
        ("MountainCar-v0", {"low": "left"}, ValueError),
        ("Acrobot-v1", {"high": None}, ValueError),
        ("Pendulum-v1", {"x_init": -1.0}, ValueError),
        ("CartPole-v1", {"low": float("-inf")}, OverflowError),
    ],
)
def test_bad_options_raise_gymnasiums_error(name, options, error):
    with pytest.raises(error) as gymnasiums:
        gym.make(name).reset(options=options)
    env = ours(name, 2)
    env.reset(seed=1)
    before = standing(env)
    with pytest.raises(error) as mine:
        env.reset(seed=5, options=options)
    assert str(mine.value) == str(gymnasiums.value)
    assert data_equivalence(standing(env), before, exact=True)


@pytest.mark.parametrize(
    ("arguments", "error", "match"),
    [
        ({"num_envs": 0}, ValueError, "num_envs must"),
        ({"num_envs": 2.0}, TypeError, "num_envs must"),
        ({"num_envs": 2, "threads": 0}, ValueError, "threads must"),
        ({"num_envs": 2, "threads": "many"}, TypeError, "threads must"),
        ({"num_envs": 2, "threads": 10**25}, ValueError, "threads must be an integer from 1 to 1024, got 1000"),
        ({"num_envs": 2, "goal": 1}, TypeError, "goal"),
    ],
)
def test_bad_arguments_are_refused_by_name(arguments, error, match):
    with pytest.raises(error, match=match):
        gym.make_vec("qtab/MountainCar-v0", **arguments)


def test_the_longest_time_limit_is_no_limit():
    env = ours("CartPole-v1", 2, max_episode_steps=2**70)
    env.reset(seed=0)
    assert env.unwrapped.is_native
    assert not env.step(np.zeros(2, np.int64))[3].any()


def test_an_array_that_was_given_another_size_is_refused():
    env = ours("CartPole-v1", 3, copy=False)
    observations, _ = env.reset(seed=0)
    observations.resize((2, 4), refcheck=False)
    with pytest.raises(ValueError, match="the array of observations must keep its 3 rows"):
        env.step(np.zeros(3, np.int64))


def test_indices_beyond_the_sub_environments_are_refused():
    env = ours("CartPole-v1", 2).unwrapped
    env.reset(seed=0)
    for call in (
        env.seed_of,
        env.rng,
        lambda lane: env.set_rng(lane, None),
        lambda lane: env.native_reset([lane], [3], None),
    ):
        with pytest.raises(IndexError, match="there is no sub-environment 2"):
            call(2)


def test_an_unknown_id_has_no_entry_point():
    import qtab.envs.vector as module

    with pytest.raises(AttributeError, match="has no attribute 'Ant-v5'"):
        getattr(module, "Ant-v5")
