"""Attributes that Gymnasium lets a user assign are used, and copies continue from the state of the original."""

import copy
import pickle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy._core._exceptions import _UFuncOutputCastingError

import qtab  # noqa: F401 - registers the environment
from qtab._core import parameter_names
from support.exact import assert_identical
from support.parity import energy_policy, state_bytes


def pair(seed=0):
    envs = gym.make("qtab/MountainCar-v0").unwrapped, gym.make("MountainCar-v0").unwrapped
    for env in envs:
        env.reset(seed=seed)
    return envs


def walk(ours, theirs, steps=150):
    """Steps both environments and compares everything."""
    for step in range(steps):
        action = energy_policy(np.array(theirs.state, dtype=np.float64)) if step % 7 else step % 3
        assert_identical(ours.step(action), theirs.step(action))
        assert state_bytes(ours) == state_bytes(theirs)


STATES = [
    (-0.5, 0.01),
    [-0.5, 0.01],
    np.array([-0.5, 0.01]),
    (np.float64(0.45), np.float64(0.06)),
    np.array([-0.5, 0.01], dtype=np.float32),
    (np.float32(-1.19), np.float32(-0.05)),
    (np.float32(0.3), 0.01),
    (np.float16(-0.5), np.float16(0.01)),
    (0, 0),
    [-1, 0],
    np.array([0, 0]),
    (-1.2, -0.07),
    (0.6, 0.07),
    (-5.0, 3.0),
]


@pytest.mark.parametrize("state", STATES, ids=repr)
def test_steps_from_an_assigned_state_equal_gymnasiums(state):
    ours, theirs = pair()
    ours.state, theirs.state = copy.copy(state), copy.copy(state)
    assert np.array_equal(np.array(ours.state), np.array(theirs.state))
    try:
        first = theirs.step(2)
    except _UFuncOutputCastingError as error:  # integers that NumPy cannot add a float to
        with pytest.raises(type(error)):
            ours.step(2)
        return
    assert_identical(ours.step(2), first)
    walk(ours, theirs)


def test_the_state_has_the_types_of_gymnasiums():
    ours, theirs = pair()
    for _ in range(3):
        assert type(ours.state) is type(theirs.state)
        assert [type(number) for number in ours.state] == [type(number) for number in theirs.state]
        ours.step(2), theirs.step(2)


def test_a_state_edited_in_place_after_a_reset_is_used():
    ours, theirs = pair()
    for env in (ours, theirs):
        env.state[0] = 0.3
    walk(ours, theirs)


def test_a_state_of_three_numbers_raises_gymnasiums_error():
    for env in pair():
        env.state = (0.0, 0.0, 0.0)
        with pytest.raises(ValueError, match="too many values to unpack"):
            env.step(0)


def test_a_state_of_none_needs_a_reset():
    ours, _ = pair()
    ours.state = None
    assert ours.state is None
    with pytest.raises(gym.error.ResetNeeded):
        ours.step(0)
    ours.reset(seed=0)
    assert ours.step(0)[1] == -1.0


def test_an_infinite_position_raises_gymnasiums_error():
    texts = []
    for env in pair():
        env.state = (float("inf"), 0.0)
        with pytest.raises(ValueError) as caught:
            env.step(0)
        texts.append(str(caught.value))
    assert texts[0] == texts[1]


def test_rust_steps_again_after_a_reset_of_an_unsupported_state():
    ours, theirs = pair()
    for env in (ours, theirs):
        env.state = np.array([-0.5, 0.0], dtype=np.float32)
        env.step(0)
        env.reset(seed=1)
    walk(ours, theirs)


VALUES = {
    "gravity": [0.003, 0.0, -0.0025, np.float32(0.0025), 1, np.float64(0.002)],
    "force": [0.002, 0, np.float32(0.0015), -0.001],
    "goal_position": [-0.4, 0.45, 1, np.float32(0.5), float("inf")],
    "goal_velocity": [0.05, 0, np.float32(0.01), -1.0],
    "max_speed": [0.03, 0.2, 0.0, np.float32(0.05), 1],
    "min_position": [-0.7, -2.0, np.float32(-0.9), -1],
    "max_position": [0.3, 2.0, np.float32(0.4), 0],
}
ASSIGNMENTS = [(name, value) for name, values in VALUES.items() for value in values]


def test_every_constant_of_the_physics_is_assigned_below():
    assert set(parameter_names("MountainCar")) == set(VALUES)


@pytest.mark.parametrize(("name", "value"), ASSIGNMENTS)
def test_an_assigned_constant_is_honoured(name, value):
    ours, theirs = pair()
    for env in (ours, theirs):
        setattr(env, name, value)
        assert getattr(env, name) == value
    walk(ours, theirs)


@pytest.mark.parametrize("name", VALUES)
def test_a_constant_that_is_not_a_number_is_honoured_too(name):
    ours, theirs = pair()
    setattr(ours, name, float("nan"))
    setattr(theirs, name, float("nan"))
    for action in (0, 1, 2, 2):
        assert_identical(ours.step(action), theirs.step(action))


NUMBERS = st.floats(-0.2, 0.2)


@given(values=st.fixed_dictionaries(dict.fromkeys(VALUES, NUMBERS)), position=st.floats(-0.3, 0.3))
def test_steps_with_any_constants_equal_gymnasiums(values, position):
    ours, theirs = pair()
    for env in (ours, theirs):
        for name, value in values.items():
            setattr(env, name, value)
        env.state = (position, 0.01)
    walk(ours, theirs, steps=6)


def test_constants_belong_to_one_environment():
    one: Any = gym.make("qtab/MountainCar-v0").unwrapped
    other: Any = gym.make("qtab/MountainCar-v0").unwrapped
    one.gravity = 0.0
    assert other.gravity == 0.0025


def test_restoring_a_constant_restores_the_default_steps():
    ours, theirs = pair()
    ours.gravity = np.float32(0.1)
    ours.gravity = 0.0025
    walk(ours, theirs)


COPIES: dict[str, Any] = {"deepcopy": copy.deepcopy, "pickle": lambda env: pickle.loads(pickle.dumps(env))}  # noqa: S301 - our own


@pytest.mark.parametrize("made", COPIES.values(), ids=COPIES)
def test_a_copy_made_during_an_episode_continues_like_the_original(made):
    env: Any = gym.make("qtab/MountainCar-v0", goal_velocity=0.01)
    env.unwrapped.gravity = 0.0024
    env.unwrapped.force = np.float32(0.001)
    env.reset(seed=4)
    for _ in range(30):
        env.step(2)
    twin = made(env)
    assert state_bytes(twin) == state_bytes(env)
    assert (twin.unwrapped.gravity, twin.unwrapped.goal_velocity) == (0.0024, 0.01)
    assert type(twin.unwrapped.force) is np.float32
    for step in range(400):
        one, other = env.step(step % 3), twin.step(step % 3)
        assert_identical(one, other)
        if one[2] or one[3]:
            assert_identical(env.reset(), twin.reset())


@pytest.mark.parametrize("made", COPIES.values(), ids=COPIES)
def test_a_copy_and_its_original_are_independent(made):
    env: Any = gym.make("qtab/MountainCar-v0").unwrapped
    env.reset(seed=4)
    twin = made(env)
    before = state_bytes(env)
    twin.gravity = 1.0
    twin.step(2)
    assert state_bytes(env) == before
    assert env.gravity == 0.0025


def test_an_environment_that_was_never_reset_can_be_copied():
    twin = copy.deepcopy(gym.make("qtab/MountainCar-v0"))
    assert twin.reset(seed=0)[0].tobytes() == gym.make("MountainCar-v0").reset(seed=0)[0].tobytes()
