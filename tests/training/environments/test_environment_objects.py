"""An environment that is passed in counts as it is, and is not closed."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import RecordEpisodeStatistics, TimeLimit, TransformReward

import qtab
from support.environments import ScriptedEnv, Walk
from support.parity import assert_same_as_reference, assert_same_run

ONE = np.array([1.0], np.float32)


def test_an_object_has_the_preset_of_its_id():
    run = qtab.train(gym.make("qtab/MountainCar-v0"), seed=3, episodes=20)
    assert run.config.preset == "article"
    assert_same_run(run, qtab.train("MountainCar-v0", seed=3, episodes=20))


@pytest.mark.parametrize("env", ["MountainCar-v0", "qtab/MountainCar-v0"])
def test_an_edited_object_is_stepped_as_edited(env):
    def edited(name):
        made: Any = gym.make(name)
        made.unwrapped.gravity = 0.0015
        made.unwrapped.goal_position = -0.2
        return made

    run = qtab.train(edited(env), seed=3, episodes=20)
    assert run.terminated.any()
    assert_same_as_reference(run, edited("MountainCar-v0"))


def test_wrappers_are_stepped_through():
    env = RecordEpisodeStatistics(TransformReward(gym.make("MountainCar-v0"), lambda reward: 3 * float(reward)))
    run = qtab.train(env, seed=3, episodes=4)
    assert run.episode_returns.tolist() == [-600.0] * 4
    assert list(env.return_queue) == [-600.0] * 4


def test_a_run_has_the_time_limit_of_its_object_unless_a_shorter_one_is_given():
    assert qtab.train(TimeLimit(Walk(), 7), scale=(1, 1), seed=0, episodes=3).config.max_episode_steps == 7
    run = qtab.train(gym.make("MountainCar-v0"), seed=0, episodes=3, max_episode_steps=9)
    assert run.episode_lengths.tolist() == [9, 9, 9]


def test_only_the_first_reset_is_seeded():
    env = ScriptedEnv([ONE])
    qtab.train(env, scale=(1,), seed=2**70, episodes=4)
    assert env.seeds == [2**70, None, None, None]
    assert type(env.seeds[0]) is int


def test_every_action_is_a_python_integer_of_the_space():
    env = ScriptedEnv([ONE], actions=gym.spaces.Discrete(3, start=5))
    run = qtab.train(env, scale=(1,), seed=0, episodes=30, epsilon=1.0, min_epsilon=1.0)
    assert {type(action) for action in env.taken} == {int}
    assert set(env.taken) == {5, 6, 7}
    assert run.policy.min() >= 5
    assert run.predict(ONE)[0] in (5, 6, 7)


def test_an_object_is_not_closed_whether_training_ends_well_or_not():
    env = ScriptedEnv([ONE])
    qtab.train(env, scale=(1,), seed=0, episodes=2)
    with pytest.raises(ValueError):
        qtab.train(ScriptedEnv([ONE, 9 * ONE]), scale=(1,), seed=0, episodes=2)
    with pytest.raises(ValueError):
        qtab.train(env, scale=(1, 1), seed=0, episodes=2)
    assert env.closed is False


@pytest.mark.filterwarnings("ignore:.*not within the observation space")
def test_an_environment_made_from_an_id_is_closed_whether_training_ends_well_or_not():
    made = []

    def make(**kwargs):
        made.append(ScriptedEnv(**kwargs))
        return made[-1]

    gym.register("QtabTests/Scripted-v0", entry_point=make, kwargs={"observations": [ONE]})
    try:
        qtab.train("QtabTests/Scripted-v0", scale=(1,), seed=0, episodes=2)
        with pytest.raises(ValueError):
            qtab.train(
                "QtabTests/Scripted-v0", scale=(1,), seed=0, episodes=2, env_kwargs={"observations": [ONE, 9 * ONE]}
            )
        with pytest.raises(ValueError):
            qtab.train("QtabTests/Scripted-v0", scale=(1, 2), seed=0, episodes=2)
    finally:
        del gym.registry["QtabTests/Scripted-v0"]
    assert [env.closed for env in made] == [True, True, True]


def test_both_flags_at_once_count_as_terminated():
    class Both(ScriptedEnv):
        def step(self, action):
            observation, reward, terminated, _, info = super().step(action)
            return observation, reward, np.bool_(terminated), terminated, info

    run = qtab.train(Both([ONE]), scale=(1,), seed=0, episodes=3, learning_rate=1.0, initial_q=(0.0, 0.0), discount=1.0)
    assert run.terminated.all()
    assert run.q_values(ONE).min() >= -3 * 8
    assert_same_as_reference(run, Both([ONE]))


@pytest.mark.parametrize(
    "observation", [[1.0], np.array([1]), np.array([1, 2, 3, 4], np.float32)[::4], (np.float64(1),)]
)
def test_whatever_numpy_converts_is_an_observation(observation):
    run = qtab.train(ScriptedEnv([observation]), scale=(1,), seed=0, episodes=3)
    assert_same_run(run, qtab.train(ScriptedEnv([ONE]), scale=(1,), seed=0, episodes=3))


@pytest.mark.parametrize("reward", [-1, np.float32(-1), np.float64(-1), np.array(-1.0), np.int8(-1)])
def test_whatever_python_converts_to_float_is_a_reward(reward):
    run = qtab.train(ScriptedEnv([ONE], rewards=[reward]), scale=(1,), seed=0, episodes=3)
    assert_same_run(run, qtab.train(ScriptedEnv([ONE]), scale=(1,), seed=0, episodes=3))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_box_of_many_axes_gives_the_references_table(dtype):
    rng = np.random.default_rng(0)
    observations = rng.uniform(0, 4, (50, 5)).astype(dtype)

    def env():
        return ScriptedEnv(observations, dtype=dtype, dimensions=5, rewards=rng_rewards)

    rng_rewards = rng.normal(size=17).tolist()
    run = qtab.train(env(), scale=(1, 2, 0.5, 1.5, 3), seed=0, episodes=20)
    assert run.q_table.shape == (5, 9, 3, 7, 13, 2)
    assert_same_as_reference(run, env())


def test_recordings_hold_the_last_episodes_and_do_not_change_the_run():
    run = qtab.train("MountainCar-v0", seed=1, episodes=12, record=5)
    assert [recording.episode for recording in run.recordings] == [7, 8, 9, 10, 11]
    assert [len(recording.actions) for recording in run.recordings] == run.episode_lengths[-5:].tolist()
    for other in (
        qtab.train("MountainCar-v0", seed=1, episodes=12),
        qtab.train("MountainCar-v0", seed=1, episodes=12, record=99, backend="gymnasium"),
    ):
        assert_same_run(run, other)
