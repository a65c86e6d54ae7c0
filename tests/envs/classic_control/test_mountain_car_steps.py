"""qtab/MountainCar-v0 steps as Gymnasium's MountainCar-v0 does, to the last bit."""

import math
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab  # noqa: F401 - registers the environment
from support.exact import assert_identical
from support.parity import energy_policy, state_bytes

STEPS_PER_SEED = 4_000


def pair(**kwargs: Any) -> tuple[Any, Any]:
    return gym.make("qtab/MountainCar-v0", **kwargs), gym.make("MountainCar-v0", **kwargs)


def random_policy(rng, observation):
    return int(rng.integers(3))


def pumping_policy(rng, observation):
    return energy_policy(observation)


def mixed_policy(rng, observation):
    return energy_policy(observation) if rng.random() < 0.8 else int(rng.integers(3))


def assert_same_walk(ours, theirs, policy, seed, steps):
    """Returns how many episodes ended at the goal and how many by the time limit."""
    rng = np.random.default_rng(seed)
    ended = {"goal": 0, "time": 0}
    one, other = ours.reset(seed=seed), theirs.reset(seed=seed)
    assert_identical(one, other)
    for _ in range(steps):
        action = policy(rng, other[0])
        one, other = ours.step(action), theirs.step(action)
        assert_identical(one, other)
        assert state_bytes(ours) == state_bytes(theirs)
        if other[2] or other[3]:
            ended["goal"] += other[2]
            ended["time"] += other[3]
            one, other = ours.reset(), theirs.reset()
            assert_identical(one, other)
            assert state_bytes(ours) == state_bytes(theirs)
    assert ours.unwrapped.np_random.bit_generator.state == theirs.unwrapped.np_random.bit_generator.state
    return ended


@pytest.mark.parametrize("seed", [0, 2**32 - 1, 2**70])
def test_random_walks_equal_gymnasiums(seed):
    assert assert_same_walk(*pair(), random_policy, seed, STEPS_PER_SEED)["time"] > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_walks_of_the_energy_policy_equal_gymnasiums(seed):
    assert assert_same_walk(*pair(), pumping_policy, seed, STEPS_PER_SEED)["goal"] > 30


@pytest.mark.parametrize("seed", [3, 4])
def test_mixed_walks_equal_gymnasiums(seed):
    assert assert_same_walk(*pair(), mixed_policy, seed, STEPS_PER_SEED)["goal"] > 10


def test_walks_without_a_time_limit_equal_gymnasiums():
    ended = assert_same_walk(*pair(max_episode_steps=10**9), random_policy, 5, STEPS_PER_SEED)
    assert ended["time"] == 0


def test_the_goal_velocity_decides_as_in_gymnasium():
    fast = assert_same_walk(*pair(goal_velocity=0.03), pumping_policy, 6, 4000)
    never = assert_same_walk(*pair(goal_velocity=0.08), pumping_policy, 6, 4000)
    assert fast["goal"] > 0
    assert never["goal"] == 0


def around(value, spread):
    """Any number nearby, and those at which comparisons change."""
    edges = [value, math.nextafter(value, -1.0), math.nextafter(value, 1.0)]
    return st.sampled_from(edges) | st.floats(value - spread, value + spread)


POSITIONS = around(-1.2, 0.3) | around(0.5, 0.1) | around(0.6, 0.2) | st.floats(-1.5, 0.9) | st.just(-0.0)
VELOCITIES = around(-0.07, 0.05) | around(0.07, 0.05) | around(0.0, 1e-3) | st.just(-0.0)


@given(position=POSITIONS, velocity=VELOCITIES, actions=st.lists(st.integers(0, 2), min_size=1, max_size=5))
def test_a_step_from_any_state_equals_gymnasiums(position, velocity, actions):
    ours, theirs = (env.unwrapped for env in pair())
    for env in (ours, theirs):
        env.reset(seed=0)
        env.state = (position, velocity)
    for action in actions:
        assert_identical(ours.step(action), theirs.step(action))
        assert state_bytes(ours) == state_bytes(theirs)


@given(
    low=st.floats(-1.2, 0.0),
    width=st.floats(0.0, 0.6),
    seed=st.integers(0, 2**70),
)
def test_resets_within_bounds_equal_gymnasiums(low, width, seed):
    ours, theirs = pair()
    options = {"low": low, "high": low + width}
    assert_identical(ours.reset(seed=seed, options=options), theirs.reset(seed=seed, options=options))
    assert state_bytes(ours) == state_bytes(theirs)
    assert_identical(ours.step(2), theirs.step(2))
    assert options == {"low": low, "high": low + width}


@pytest.mark.parametrize("options", [{"low": -0.5}, {"high": -0.3}, {}, {"low": np.float32(-0.5), "high": 0}])
def test_resets_within_one_given_bound_equal_gymnasiums(options):
    ours, theirs = pair()
    assert_identical(ours.reset(seed=3, options=options), theirs.reset(seed=3, options=options))


def test_a_reset_without_a_seed_continues_the_generator():
    ours, theirs = pair()
    ours.reset(seed=9), theirs.reset(seed=9)
    for _ in range(20):
        assert_identical(ours.reset(), theirs.reset())


def test_an_assigned_generator_is_used():
    ours, theirs = pair()
    for env in (ours, theirs):
        env.unwrapped.np_random = np.random.Generator(np.random.Philox(4))
    assert_identical(ours.reset(), theirs.reset())


@pytest.mark.parametrize("action", [0, 2, True, np.int64(2), np.int8(0), np.array(2), np.int32(1)])
def test_every_integer_type_is_an_action(action):
    ours, theirs = pair()
    ours.reset(seed=0), theirs.reset(seed=0)
    assert_identical(ours.step(action), theirs.step(int(action)))
