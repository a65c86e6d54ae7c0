"""The interface of Gymnasium's vector environments, and how users use it."""

import copy
import multiprocessing
import threading
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from support.exact import bitwise
from support.lockstep.vector import IDS, MODES, LockstepVectorEnv, assert_equal, ours, theirs

pytestmark = pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date")


@pytest.mark.parametrize("name", IDS)
def test_make_vec_makes_the_vector_environment_in_rust(name):
    env = ours(name, 3)
    assert type(env.unwrapped).__module__ == "qtab.envs.vector.rust_vector_env"
    assert env.is_native
    assert env.num_envs == 3
    other = theirs(name, 3)
    for space in ("observation_space", "action_space", "single_observation_space", "single_action_space"):
        assert getattr(env, space) == getattr(other, space)
    assert env.metadata == {**other.metadata, "autoreset_mode": AutoresetMode.NEXT_STEP}
    if not name.startswith("CartPole"):
        assert env.spec.id == f"qtab/{name}"
        assert repr(env) == f"RustVectorEnv(qtab/{name}, num_envs=3)"
    assert not gym.make(f"qtab/{name}").unwrapped.metadata.get("autoreset_mode")
    env.close()
    assert env.closed
    env.close()


@pytest.mark.parametrize("mode", MODES)
def test_the_mode_is_the_enum_or_its_value(mode):
    for given in (mode, mode.value):
        assert ours("CartPole-v1", 2, autoreset_mode=given).metadata["autoreset_mode"] is mode
    with pytest.raises(ValueError, match="'Sometimes' is not a valid AutoresetMode"):
        ours("CartPole-v1", 2, autoreset_mode="Sometimes")


def test_gymnasiums_own_vectorization_modes_work_too():
    env = ours("FrozenLake-v1", 2, vectorization_mode="sync")
    assert isinstance(env, SyncVectorEnv)
    assert_equal(env.reset(seed=1), ours("FrozenLake-v1", 2).reset(seed=1))


@pytest.mark.parametrize("name", ["MountainCar-v0", "FrozenLake-v1", "Blackjack-v1"])
def test_observations_are_copied_unless_copy_is_false(name):
    def arrays(observations):
        return observations if isinstance(observations, tuple) else (observations,)

    one, same = ours(name, 5), ours(name, 5, copy=False)
    kept, _ = one.reset(seed=0)
    before = copy.deepcopy(kept)
    shown, _ = same.reset(seed=0)
    for step in range(6):
        again, *_ = same.step(np.ones(5, np.int64))
        fresh, *_ = one.step(np.ones(5, np.int64))
        for first, second, third in zip(arrays(shown), arrays(again), arrays(fresh), strict=True):
            assert np.shares_memory(first, second)
            assert not np.shares_memory(first, third)
            assert first.tobytes() == third.tobytes(), step
    assert data_equivalence(kept, before, exact=True)


def test_rewards_and_flags_are_new_arrays():
    env = ours("CartPole-v1", 3, copy=False)
    env.reset(seed=0)
    _, *first, _ = env.step(np.array([0, 1, 0]))
    _, *second, _ = env.step(np.array([0, 1, 0]))
    assert not any(np.shares_memory(one, other) for one, other in zip(first, second, strict=True))


@pytest.mark.parametrize("name", ["MountainCar-v0", "Taxi-v4", "Pendulum-v1"])
def test_seeds_equal_gymnasiums(name):
    vectors = LockstepVectorEnv(name, 3)
    for seed in (0, 12, [5, 6, 2**80], (1, 2, 3), [7, None, 2**32], True, None):
        if seed is None or None in (seed if isinstance(seed, list) else []):
            vectors.ours.reset(seed=seed)
            vectors.theirs.reset(seed=list(vectors.ours.np_random_seed))
            vectors.ours.reset(seed=list(vectors.ours.np_random_seed))
        else:
            vectors.reset(seed=seed)
        vectors.same_streams()


def test_without_a_seed_no_two_vector_environments_are_equal():
    env, other = ours("Taxi-v4", 50), ours("Taxi-v4", 50)
    seeds = {*env.np_random_seed, *other.np_random_seed}
    assert len(seeds) == 100
    env.reset()
    assert len({generator.random() for generator in env.np_random}) == 50
    assert env.np_random_seed == env.np_random_seed


@pytest.mark.parametrize("name", ["MountainCar-v0", "FrozenLake-v1", "Blackjack-v1", "Taxi-v4"])
@pytest.mark.parametrize("mode", MODES)
def test_generators_that_were_accessed_are_drawn_from(name, mode):
    vectors = LockstepVectorEnv(name, 4, mode, max_episode_steps=5)
    vectors.reset(seed=3)
    vectors.run(7)
    mine, gymnasiums = vectors.ours.np_random, vectors.theirs.np_random
    assert all(one is other for one, other in zip(mine, vectors.ours.np_random, strict=True))
    for lane in (0, 2):  # the user draws from them as well
        assert mine[lane].random() == gymnasiums[lane].random()
        assert mine[lane].integers(3) == gymnasiums[lane].integers(3)
    vectors.run(20)
    vectors.same_streams()
    assert vectors.ours.is_native
    # A seed makes new generators; those accessed before are no longer used.
    vectors.reset(seed=[1, 2, 3, 4])
    vectors.run(9)
    vectors.same_streams()
    assert vectors.ours.np_random[0] is not mine[0]
    with pytest.raises(AttributeError):
        vectors.ours.np_random = mine


def test_threads_draw_from_accessed_generators():
    vectors = LockstepVectorEnv("Acrobot-v1", 9, AutoresetMode.SAME_STEP, {"threads": 3}, max_episode_steps=4)
    vectors.reset(seed=3)
    assert len(vectors.ours.np_random) == 9
    vectors.run(20)
    vectors.same_streams()


ENOUGH_FOR_TWO_THREADS = {"Acrobot-v1": 1025, "Pendulum-v1": 4097, "MountainCar-v0": 65_537}
"""Sub-environments for two threads; those of other ids are at most 16,384 a thread."""


@pytest.mark.parametrize(("count", "is_other"), [(1023, False), (1024, True)])
def test_a_thread_starts_only_where_it_has_enough_to_do(count, is_other):
    env = ours("Acrobot-v1", count, threads=2, max_episode_steps=1).unwrapped
    env.reset(seed=0)
    threads = set()

    class Watching(np.random.Generator):
        def random(self, *arguments: Any) -> Any:  # type: ignore[override]
            threads.add(threading.get_ident())
            return super().random(*arguments)

    env.set_rng(count - 1, Watching(np.random.PCG64(0)))
    for _ in range(2):
        env.step(np.zeros(count, np.int64))
    assert len(threads) == 1
    assert (threads != {threading.get_ident()}) == is_other


@pytest.mark.parametrize("name", IDS)
def test_any_number_of_threads_gives_the_same(name):
    rng = np.random.default_rng(0)
    count = ENOUGH_FOR_TWO_THREADS.get(name, 32_769)
    envs = [ours(name, count, threads=threads, max_episode_steps=5) for threads in (1, 50)]
    resets = [env.reset(seed=1) for env in envs]
    space = envs[0].single_action_space
    for _ in range(8):
        if isinstance(space, gym.spaces.Discrete):
            actions = rng.integers(0, space.n, count)
        else:
            actions = rng.uniform(space.low, space.high, (count, 1)).astype(np.float32)
        steps = [env.step(actions) for env in envs]
        assert all(data_equivalence(step, steps[0], exact=True) for step in steps)
    assert all(data_equivalence(reset, resets[0], exact=True) for reset in resets)


def test_termination_at_the_time_limit_sets_both_flags():
    vectors = LockstepVectorEnv("MountainCar-v0", 6, max_episode_steps=1)
    vectors.reset(seed=0, options={"low": 0.49, "high": 0.499})
    _, _, terminated, truncated, _ = vectors.step(np.full(6, 2))
    vectors.reset(seed=0, options={"low": 0.49999, "high": 0.5})
    assert truncated.all()
    vectors = LockstepVectorEnv("Blackjack-v1", 6, max_episode_steps=1)
    vectors.reset(seed=0)
    _, _, terminated, truncated, _ = vectors.step(np.zeros(6, np.int64))
    assert terminated.all()
    assert truncated.all()


def test_time_limits_equal_gymnasiums():
    assert ours("CartPole-v0", 1).get_attr("_max_episode_steps") == (200,)
    assert ours("CartPole-v1", 1, max_episode_steps=3).get_attr("_max_episode_steps") == (3,)
    for name, limit in (("CartPole-v1", -1), ("CliffWalking-v1", None)):
        vectors = LockstepVectorEnv(name, 2, max_episode_steps=limit)
        vectors.reset(seed=0)
        vectors.run(300)
    with pytest.raises((TypeError, ValueError, AssertionError)):
        ours("CartPole-v1", 1, max_episode_steps=0)


def test_a_finished_sub_environment_must_be_reset_where_autoreset_is_disabled():
    vectors = LockstepVectorEnv("CartPole-v1", 3, AutoresetMode.DISABLED)
    vectors.reset(seed=0)
    vectors.reset(options={"reset_mask": np.array([False, True, False]), "low": 0.3, "high": 0.4})
    _, _, terminated, _, _ = vectors.step(np.ones(3, np.int64))
    assert terminated.tolist() == [False, True, False]
    before = vectors.ours.snapshots()
    for env in (vectors.ours, vectors.theirs):
        with pytest.raises(AssertionError):
            env.step(np.ones(3, np.int64))
    with pytest.raises(AssertionError, match="episode of sub-environment 1 is over: reset it first"):
        vectors.ours.step(np.ones(3, np.int64))
    assert bitwise(before[0][3]) == bitwise(vectors.ours.snapshots()[0][3])


def _steps_of_a_child(env, queue):
    queue.put(env.step(np.zeros(40, np.int64))[0].tobytes())


def test_a_forked_child_continues_stepping():
    env = ours("CartPole-v1", 40, threads=2)
    env.reset(seed=0)
    env.step(np.zeros(40, np.int64))
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=_steps_of_a_child, args=(env, queue))
    child.start()
    assert queue.get(timeout=600) == env.step(np.zeros(40, np.int64))[0].tobytes()
    child.join(600)
    assert child.exitcode == 0


def test_a_vector_environment_can_be_made_again_from_its_spec():
    env = ours("Pendulum-v1", 3, g=9.81, autoreset_mode="SameStep", max_episode_steps=7)
    again = gym.make_vec(gym.envs.registration.EnvSpec.from_json(gym.spec("qtab/Pendulum-v1").to_json()), num_envs=3)
    inner: Any = again.unwrapped
    assert inner.is_native
    same = gym.make_vec(env.spec)
    assert same.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    assert_equal(env.reset(seed=3), same.reset(seed=3))
    for _ in range(9):
        assert_equal(env.step(np.ones((3, 1), np.float32)), same.step(np.ones((3, 1), np.float32)))
