"""What Gymnasium expects of an environment: spec, spaces, errors, checks, wrappers, vector environments."""

import subprocess
import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import SyncVectorEnv
from gymnasium.wrappers import RecordEpisodeStatistics, TimeLimit, TransformReward

import qtab  # noqa: F401 - registers the environment
from support.exact import assert_identical
from support.parity import energy_policy


@pytest.fixture
def pair():
    return gym.make("qtab/MountainCar-v0"), gym.make("MountainCar-v0")


def test_spec_spaces_and_metadata_equal_gymnasiums(pair):
    ours, theirs = pair
    assert ours.observation_space == theirs.observation_space
    assert ours.observation_space.dtype == np.float32
    assert ours.action_space == theirs.action_space
    assert ours.metadata == theirs.metadata
    assert ours.unwrapped.get_keys_to_action() == theirs.unwrapped.get_keys_to_action()
    for name in ("max_episode_steps", "reward_threshold", "nondeterministic", "order_enforce"):
        assert getattr(ours.spec, name) == getattr(theirs.spec, name), name
    assert ours.spec.id == "qtab/MountainCar-v0"
    assert isinstance(ours.unwrapped, type(theirs.unwrapped))


@pytest.mark.filterwarnings("ignore::UserWarning")  # advice that Gymnasium's own environment does not follow either
def test_gymnasiums_own_check_passes():
    check_env(gym.make("qtab/MountainCar-v0", render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize("action", [3, -1, 1.0, "x", None, np.array([1]), 2**70, np.float32(1), [1], np.array(5)])
def test_a_bad_action_raises_gymnasiums_error(pair, action):
    texts = []
    for env in (*pair, *(env.unwrapped for env in pair)):
        env.reset(seed=0)
        with pytest.raises(AssertionError) as caught:
            env.step(action)
        texts.append(str(caught.value))
    wrapped, theirs_wrapped, bare, theirs_bare = texts
    assert wrapped == theirs_wrapped
    assert bare == theirs_bare == f"{action!r} ({type(action)}) invalid"


def test_a_refused_action_leaves_the_state_as_it_was(pair):
    ours, _ = pair
    ours.reset(seed=0)
    before = ours.unwrapped.state
    with pytest.raises(AssertionError):
        ours.step(3)
    assert tuple(ours.unwrapped.state) == tuple(before)


@pytest.mark.parametrize("seed", [-1, 1.5, "zero", np.int64(3)])
def test_a_bad_seed_raises_gymnasiums_error(pair, seed):
    texts = []
    for env in pair:
        with pytest.raises(gym.error.Error) as caught:
            env.reset(seed=seed)
        texts.append((type(caught.value), str(caught.value)))
    assert texts[0] == texts[1]


def test_stepping_before_a_reset_is_refused_wrapped_and_unwrapped(pair):
    for env in (pair[0], pair[0].unwrapped):
        with pytest.raises(gym.error.ResetNeeded, match="reset"):
            env.step(0)


def test_bad_reset_bounds_raise_gymnasiums_error(pair):
    texts = []
    for env in pair:
        with pytest.raises(ValueError) as caught:
            env.reset(options={"low": 0.5, "high": -0.5})
        texts.append(str(caught.value))
    assert texts[0] == texts[1]


def test_an_unknown_keyword_argument_is_refused():
    with pytest.raises(TypeError, match="nonsense"):
        gym.make("qtab/MountainCar-v0", nonsense=1)


def test_gymnasiums_wrappers_return_the_same_around_ours(pair):
    def wrapped(env):
        return RecordEpisodeStatistics(TimeLimit(TransformReward(env, lambda reward: 2 * float(reward)), 50))

    ours, theirs = map(wrapped, pair)
    one, other = ours.reset(seed=2), theirs.reset(seed=2)
    while not (other[2] or other[3] if len(other) == 5 else False):
        action = energy_policy(other[0])
        one, other = ours.step(action), theirs.step(action)
        assert_identical(one[:4], other[:4])
    assert other[3]
    for env_info in (one[4], other[4]):
        del env_info["episode"]["t"]  # seconds
    assert one[4] == other[4] == {"episode": {"r": -100.0, "l": 50}}


def test_gym_make_imports_the_package_in_a_fresh_process():
    code = (
        "import gymnasium as gym\n"
        "env = gym.make('qtab:qtab/MountainCar-v0')\n"
        "env.reset(seed=0)\n"
        "print(type(env.unwrapped).__module__, env.step(1)[1])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["qtab.envs.classic_control", "-1.0"]


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_a_sync_vector_env_of_ours_equals_gymnasiums(mode):
    kwargs: dict[str, Any] = {"vector_kwargs": {"autoreset_mode": mode}, "vectorization_mode": "sync", "num_envs": 3}
    ours, theirs = gym.make_vec("qtab/MountainCar-v0", **kwargs), gym.make_vec("MountainCar-v0", **kwargs)
    assert isinstance(ours, SyncVectorEnv)
    rng = np.random.default_rng(0)
    one: Any = ours.reset(seed=5)
    other: Any = theirs.reset(seed=5)
    assert gym.utils.env_checker.data_equivalence(one, other, exact=True)
    for _ in range(450):
        actions = rng.integers(0, 3, 3)
        one, other = ours.step(actions), theirs.step(actions)
        assert gym.utils.env_checker.data_equivalence(one, other, exact=True)


def test_an_unwrapped_class_can_be_made_without_the_registry():
    from qtab.envs.classic_control import MountainCarEnv

    ours, theirs = MountainCarEnv(goal_velocity=0.02), gym.make("MountainCar-v0", goal_velocity=0.02).unwrapped
    assert_identical(ours.reset(seed=1), theirs.reset(seed=1))
    assert_identical(ours.step(2), theirs.step(2))
    assert ours.goal_velocity == 0.02


def test_an_unknown_attribute_is_an_attribute_error(pair):
    with pytest.raises(AttributeError):
        _ = pair[0].unwrapped.speed_of_light
