"""Three implementations agree byte for byte: all in Rust, Gymnasium with the learner in Rust, and NumPy."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import TimeLimit
from hypothesis import given
from hypothesis import strategies as st

import qtab
from support.environments import ScriptedEnv, Walk
from support.parity import assert_same_as_reference, assert_same_run, table_to_go_on_from

LEARNED = table_to_go_on_from()
QUICK = 143
"""A seed with which the first episode reaches the goal after 1,304 steps, not after many thousands."""
UNIT = st.sampled_from([0.0, 0.1, 0.5, 1.0]) | st.floats(0.0, 1.0)
EPSILONS = st.tuples(UNIT, UNIT).map(sorted)
RANGES = st.sampled_from([(-1.0, 1.0), (0.0, 0.0), (-200.0, -100.0)]) | st.tuples(
    st.floats(-10, 10), st.floats(-10, 10)
).map(lambda pair: tuple(sorted(pair)))


def assert_three_ways_equal(**settings):
    """Trains on both backends and in the reference, and returns the run."""
    fast = qtab.train("MountainCar-v0", backend="rust", **settings)
    slow = qtab.train("MountainCar-v0", backend="gymnasium", **settings)
    assert fast.config.backend == "rust"
    assert slow.config.backend == "gymnasium"
    assert_same_run(fast, slow)
    limit = fast.config.max_episode_steps
    assert_same_as_reference(fast, gym.make("MountainCar-v0", max_episode_steps=limit, **fast.config.env_kwargs))
    return fast


@st.composite
def settings_of_runs(draw):
    bit_generator = draw(st.sampled_from(["PCG64", "MT19937"]))
    largest = 2**32 - 1 if bit_generator == "MT19937" else 2**140
    min_epsilon, epsilon = draw(EPSILONS)
    scale = draw(st.sampled_from([(10.0, 100.0), (4.0, 50.0), (33.3, 7.5)]))
    initial_q = draw(st.just("learned") | RANGES) if scale == (10.0, 100.0) else draw(RANGES)
    return {
        "bit_generator": bit_generator,
        "seed": draw(st.sampled_from([0, 1, 2**32 - 1]) | st.integers(0, largest)),
        "learning_rate": draw(UNIT),
        "discount": draw(UNIT),
        "epsilon": epsilon,
        "min_epsilon": min_epsilon,
        "scale": scale,
        "initial_q": LEARNED if isinstance(initial_q, str) else initial_q,
        "terminal_update": draw(st.sampled_from(["assign", "target"])),
        "max_episode_steps": draw(st.sampled_from([None, 1, 2, 37, 150])),
        "episodes": draw(st.integers(1, 3)),
        "env_kwargs": {"goal_velocity": draw(st.sampled_from([0, 0.0, 0.02, -1.0]))},
    }


@given(settings=settings_of_runs())
def test_all_three_implementations_agree_for_any_settings(settings):
    assert_three_ways_equal(**settings)


@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
@pytest.mark.parametrize("terminal_update", ["assign", "target"])
def test_all_three_implementations_agree_at_the_goal_and_at_the_time_limit(bit_generator, terminal_update):
    run = assert_three_ways_equal(
        seed=3,
        episodes=12,
        initial_q=LEARNED,
        epsilon=0.05,
        min_epsilon=0.0,
        bit_generator=bit_generator,
        terminal_update=terminal_update,
    )
    assert run.terminated.any()
    assert not run.terminated.all()
    assert (run.episode_lengths[~run.terminated] == 200).all()


def test_all_three_implementations_agree_on_long_episodes():
    run = assert_three_ways_equal(seed=QUICK, episodes=2, max_episode_steps=2000)
    assert run.terminated.any()
    assert run.episode_lengths.max() > 200


def test_the_last_step_allowed_can_reach_the_goal():
    # Terminated wins where the time limit falls on the same step.
    free = qtab.train("MountainCar-v0", seed=QUICK, episodes=1, max_episode_steps=50_000)
    assert free.terminated[0]
    run = assert_three_ways_equal(seed=QUICK, episodes=1, max_episode_steps=int(free.episode_lengths[0]))
    assert run.terminated[0]
    assert_same_run(run, free)


@pytest.mark.parametrize(("epsilon", "min_epsilon"), [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.3, 0.3), (0.8, 0.1)])
def test_all_three_implementations_agree_on_whole_schedules(epsilon, min_epsilon):
    # More episodes than the schedule's reductions sum up to exactly: it is not clamped.
    assert_three_ways_equal(seed=5, episodes=23, max_episode_steps=40, epsilon=epsilon, min_epsilon=min_epsilon)


@pytest.mark.parametrize("terminal_update", ["assign", "target"])
@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(("start", "actions"), [(0, 3), (5, 3), (-2, 4), (7, 1)])
def test_an_environment_of_a_user_gives_the_references_table(terminal_update, bit_generator, dtype, start, actions):
    run = qtab.train(
        Walk(dtype, start, actions),
        seed=8,
        episodes=5,
        scale=(2.0, 3.0),
        max_episode_steps=60,
        terminal_update=terminal_update,
        bit_generator=bit_generator,
    )
    assert_same_as_reference(run, TimeLimit(Walk(dtype, start, actions), 60))
    assert set(np.unique(run.policy)) <= set(range(start, start + actions))


@pytest.mark.parametrize("shown", [np.float64, np.float16, np.float32])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_observations_are_converted_to_the_dtype_of_the_space(dtype, shown):
    run = qtab.train(Walk(dtype, shown=shown), seed=2, episodes=12, scale=(40.0, 70.0), max_episode_steps=60)
    assert_same_as_reference(run, TimeLimit(Walk(dtype, shown=shown), 60))


def test_float64_observations_of_a_float32_space_are_rounded_as_float32():
    # In float64 just beside the boundary of two cells, in float32 on its other side.
    low, scale = np.float32(-1.2), 250.0
    halves = np.float64(low) + (np.arange(440) + 0.5) / scale
    shown = np.concatenate([halves - 1e-9, halves + 1e-9])
    in_double = np.round((shown - low) * scale)
    in_single = np.round((shown.astype(np.float32) - low) * np.float64(scale))
    observations = [np.array([value]) for value in shown[in_double != in_single]]
    assert len(observations) > 10

    def env():
        return ScriptedEnv(observations, low, 0.6, length=len(observations))

    run = qtab.train(env(), seed=0, episodes=5, scale=(scale,))
    assert_same_as_reference(run, env())


def test_training_continues_from_an_initial_table_and_does_not_change_it():
    before = LEARNED.copy()
    run = qtab.train("MountainCar-v0", seed=0, episodes=1, learning_rate=0.0, initial_q=LEARNED)
    assert run.q_table.tobytes() == before.tobytes()
    run = qtab.train("MountainCar-v0", seed=0, episodes=5, initial_q=LEARNED)
    assert run.q_table.tobytes() != before.tobytes()
    assert LEARNED.tobytes() == before.tobytes()


def test_a_table_in_another_memory_order_or_dtype_is_the_same_table():
    settings: dict[str, Any] = {"seed": 0, "episodes": 5}
    run = qtab.train("MountainCar-v0", initial_q=LEARNED, **settings)
    assert_same_run(run, qtab.train("MountainCar-v0", initial_q=np.asfortranarray(LEARNED), **settings))
    assert_same_run(run, qtab.train("MountainCar-v0", initial_q=LEARNED.tolist(), **settings))
    zeros = np.zeros((19, 15, 3))
    run = qtab.train("MountainCar-v0", initial_q=zeros, **settings)
    assert_same_run(run, qtab.train("MountainCar-v0", initial_q=zeros.astype(int), **settings))


def test_same_seed_same_table_another_seed_another_table():
    one, same, other = (qtab.train("MountainCar-v0", seed=seed, episodes=20) for seed in (4, 4, 5))
    assert_same_run(one, same)
    assert one.tables.tobytes() != other.tables.tobytes()


def test_numpy_scalars_are_accepted_as_settings():
    plain = qtab.train("MountainCar-v0", seed=4, episodes=3, learning_rate=0.5, max_episode_steps=20)
    numpys = qtab.train(
        "MountainCar-v0",
        seed=np.uint64(4),
        episodes=np.int8(3),
        learning_rate=np.float32(0.5),
        max_episode_steps=np.int16(20),
    )
    assert_same_run(plain, numpys)
    assert type(numpys.config.seed) is int
    assert type(numpys.config.learning_rate) is float


def test_the_defaults_are_the_articles():
    run = qtab.train("MountainCar-v0", seed=0, episodes=10)
    config = run.config
    assert config.preset == "article"
    assert (config.learning_rate, config.discount, config.epsilon, config.min_epsilon) == (0.2, 0.9, 0.8, 0.0)
    assert (config.scale, config.initial_q, config.terminal_update) == ((10.0, 100.0), (-1.0, 1.0), "assign")
    assert (config.max_episode_steps, config.bit_generator, qtab.Config().episodes) == (200, "PCG64", 5000)


def test_a_seed_that_is_not_given_is_drawn_and_recorded():
    one, other = (qtab.train("MountainCar-v0", episodes=3) for _ in range(2))
    assert one.config.seed != other.config.seed
    assert one.config.seed is not None
    assert 0 <= one.config.seed < 2**32
    assert_same_run(one, qtab.train("MountainCar-v0", episodes=3, seed=one.config.seed))


def test_the_config_of_a_run_repeats_it():
    run = qtab.train("MountainCar-v0", episodes=7, seed=11, discount=0.95, env_kwargs={"goal_velocity": 0.01})
    settings: dict[str, Any] = dict(vars(run.config))
    assert_same_run(run, qtab.train(settings.pop("env"), **settings))
