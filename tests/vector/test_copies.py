"""Vector environments deep-copy and pickle: the copy continues with the same numbers."""

import copy
import pickle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode

from support.lockstep.vector import IDS, MODES, ours, position

pytestmark = pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date")


def copies(env: Any) -> list[Any]:
    return [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]  # noqa: S301


def advance(env: Any, steps: int) -> list[Any]:
    """Takes random steps; where nothing resets an episode that has ended, this does."""
    results = []
    for _ in range(steps):
        results.append(env.step(env.action_space.sample()))
        over = results[-1][2] | results[-1][3]
        if env.autoreset_mode is AutoresetMode.DISABLED and over.any():
            results.append(env.reset(options={"reset_mask": over}))
    return results


def assert_continued(env: Any, others: list[Any], steps: int = 15) -> None:
    expected = advance(env, steps)
    for other in others:
        assert data_equivalence(advance(other, steps), expected, exact=True)
        for mine, original in zip(other.np_random, env.np_random, strict=True):
            assert position(mine) == position(original)
            assert mine is not original
        assert other.np_random_seed == env.np_random_seed


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", IDS)
def test_a_copy_continues_every_episode(name, mode):
    env = ours(name, 5, autoreset_mode=mode, max_episode_steps=6)
    env.reset(seed=[3, 2**70, 5, 6, 7])
    env.action_space.seed(0)
    advance(env, 7)  # at the time limit, where the next step resets
    made = copies(env)
    assert all(other.is_native for other in made)
    assert_continued(env, made)


@pytest.mark.parametrize("name", ["MountainCar-v0", "FrozenLake-v1"])
def test_generators_that_python_has_are_copied(name):
    env = ours(name, 3, max_episode_steps=5)
    env.reset(seed=1)
    env.np_random[1].random()
    made = copies(env)
    env.np_random[1].random()
    for other in made:
        other.np_random[1].random()
    env.action_space.seed(0)
    for other in made:
        other.action_space.seed(0)
    assert_continued(env, made)


@pytest.mark.parametrize("name", ["CartPole-v1", "Taxi-v4", "Pendulum-v1"])
def test_sub_environments_that_python_steps_are_copied(name):
    env = ours(name, 3, max_episode_steps=5)
    env.reset(seed=1)
    env.action_space.seed(0)
    advance(env, 3)
    assert len(env.envs) == 3
    made = copies(env)
    assert not any(other.is_native for other in made)
    assert_continued(env, made)


def test_a_copy_from_before_the_first_reset_still_needs_it():
    env = ours("MountainCar-v0", 3)
    for other in copies(env):
        assert other.np_random_seed == env.np_random_seed
        with pytest.raises(gym.error.ResetNeeded, match="sub-environment 0"):
            other.step(np.zeros(3, np.int64))
    env.reset(options={"reset_mask": np.array([True, True, True])})
    assert_continued(env, copies(env), 3)


def test_a_copy_has_arrays_and_surfaces_of_its_own():
    env = ours("MountainCar-v0", 2, copy=False, render_mode="rgb_array")
    shown, _ = env.reset(seed=1)
    frames = env.render()
    for other in copies(env):
        assert data_equivalence(other.render(), frames, exact=True)
        again, *_ = other.step(np.zeros(2, np.int64))
        assert not np.shares_memory(shown, again)
        other.close()
    env.close()


def test_wrappers_of_gymnasium_copy_with_it():
    env = gym.wrappers.vector.RecordEpisodeStatistics(ours("CartPole-v1", 3))
    env.reset(seed=1)
    for _ in range(5):
        env.step(np.ones(3, np.int64))
    other = copy.deepcopy(env)
    for _ in range(20):
        one, same = env.step(np.ones(3, np.int64)), other.step(np.ones(3, np.int64))
        for infos in (one[4], same[4]):
            infos.get("episode", {}).pop("t", None)  # seconds
        assert data_equivalence(one, same, exact=True)


def test_a_checkpoint_of_another_vector_environment_is_refused():
    env, other = ours("MountainCar-v0", 2), ours("MountainCar-v0", 3)
    saved = other.checkpoint()
    with pytest.raises(ValueError, match="seeds must be 2 of them, got 3"):
        env.restore(saved, [1, 2, 3])
    with pytest.raises(ValueError, match="the checkpoint does not fit the vector environment: it"):
        env.restore(saved, [1, 2])
    with pytest.raises(ValueError, match="the checkpoint does not fit the vector environment: it"):
        other.restore(env.checkpoint(), [1, 2, 3])
