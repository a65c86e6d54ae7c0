"""Training on TabularEnv in Rust."""

from typing import Any

import gymnasium as gym
import pytest
from gymnasium.wrappers import RecordEpisodeStatistics, TimeLimit

import qtab
from support.parity import assert_same_run

SETTINGS: dict[str, Any] = {"episodes": 200, "seed": 3, "epsilon": 0.5, "learning_rate": 0.3, "discount": 0.95}


def lake():
    env: Any = gym.make("FrozenLake-v1").unwrapped
    return qtab.TabularEnv(env.P, env.initial_state_distrib)


def test_rust_trains_on_a_tabular_env_as_python_does():
    env = lake()
    run = qtab.train(env, **SETTINGS)
    assert (run.config.backend, run.config.max_episode_steps) == ("rust", 10_000)
    assert_same_run(run, qtab.train(env, backend="gymnasium", **SETTINGS))
    assert qtab.verify(run, env=env).equal
    assert qtab.verify(run, episodes=20, env=env).equal
    assert qtab.evaluate(run, episodes=50, seed=0, env=env).lengths.sum() > 50


def test_a_tabular_env_of_the_lakes_table_trains_like_the_lake():
    one = qtab.train(TimeLimit(lake(), 100), **SETTINGS)
    other = qtab.train("FrozenLake-v1", initial_q=(-1.0, 1.0), **SETTINGS)
    assert (one.config.backend, other.config.backend) == ("rust", "rust")
    assert_same_run(one, other)


def test_an_edited_table_is_trained_as_edited():
    env = lake()
    env.P[0] = {action: [(1.0, 5, 3.0, True)] for action in range(4)}
    run = qtab.train(env, **SETTINGS)
    assert set(run.episode_returns) == {3.0}
    env.P[0][2] = [(0.5, 5, 3.0, True)]
    with pytest.raises(ValueError, match=r"got 'rust': P\[0\]\[2\] must have probabilities that sum to 1, got 0.5"):
        qtab.train(env, backend="rust", **SETTINGS)


def test_a_subclass_or_a_wrapper_is_stepped_in_python():
    class Mine(qtab.TabularEnv):
        def step(self, action):
            observation, reward, *rest = super().step(action)
            return observation, 2 * reward, *rest

    env = lake()
    assert qtab.train(Mine(env.P, env.initial_state_distrib), **SETTINGS).config.backend == "gymnasium"
    with pytest.raises(ValueError, match=r"Rust does not implement .*Mine"):
        qtab.train(Mine(env.P, env.initial_state_distrib), backend="rust", **SETTINGS)
    with pytest.raises(ValueError, match="Rust does not implement its wrapper RecordEpisodeStatistics"):
        qtab.train(RecordEpisodeStatistics(lake()), backend="rust", **SETTINGS)


@pytest.mark.parametrize("actions", [1, 2, 6, 7])
def test_tables_of_any_number_of_actions_train(actions):
    table = [[[(0.75, (state + action) % 5, action / 3, state == 4), (0.25, 0, -1, False)] for action in range(actions)]
             for state in range(5)]  # fmt: skip
    env = qtab.TabularEnv(table, [0.2] * 5)
    run = qtab.train(env, **SETTINGS, max_episode_steps=30)
    assert run.q_table.shape == (5, actions)
    assert_same_run(run, qtab.train(env, backend="gymnasium", **SETTINGS, max_episode_steps=30))
    assert qtab.verify(run, env=env).equal


def test_an_environment_of_gymnasium_trains_in_rust_when_requested():
    env = gym.make("Taxi-v4", fickle_passenger=True)
    rust = qtab.train(env, backend="rust", **SETTINGS)
    assert_same_run(rust, qtab.train(env, backend="gymnasium", **SETTINGS))


def test_many_runs_on_a_tabular_env_equal_single_runs():
    settings: dict[str, Any] = {**SETTINGS, "episodes": 40}
    del settings["seed"]
    runs = qtab.train_many(lake, seeds=4, tables=True, **settings)
    assert runs.config.backend == "rust"
    for seed, run in zip(runs.seeds, runs, strict=True):
        assert_same_run(run, qtab.train(lake(), seed=seed, **settings))
