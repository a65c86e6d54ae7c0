"""The attributes and methods of a run."""

import copy
import pickle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.results.summary import default_block


@pytest.fixture(scope="module")
def run():
    return qtab.train("MountainCar-v0", seed=0, episodes=250)


def test_the_arrays_of_a_run_have_the_documented_shapes_and_dtypes(run):
    assert (run.q_table.shape, run.q_table.dtype) == ((19, 15, 3), np.float64)
    assert (run.tables.shape, run.tables.dtype) == ((1, 285, 3), np.float64)
    assert (run.episode_returns.shape, run.episode_returns.dtype) == ((250,), np.float64)
    assert (run.episode_lengths.shape, run.episode_lengths.dtype) == ((250,), np.int64)
    assert (run.terminated.shape, run.terminated.dtype) == ((250,), np.bool_)
    assert run.completed is True
    assert run.seconds > 0.0


def test_the_policy_is_the_argmax_of_each_cell(run):
    assert run.policy.tolist() == run.q_table.argmax(axis=-1).tolist()
    level = qtab.train("MountainCar-v0", seed=0, episodes=1, initial_q=(0.0, 0.0), learning_rate=0.0)
    assert not level.policy.any()


def test_predict_has_the_signature_of_stable_baselines3(run):
    action, state = run.predict(np.array([-0.5, 0.0], np.float32), None, None, True)
    assert type(action) is int
    assert state is None
    assert action == run.predict([-0.5, 0.0], state=None, episode_start=None, deterministic=False)[0]


SETTINGS = {
    "cells": ("MountainCar-v0", {}),
    "bins": ("CartPole-v1", {}),
    "tile coding": ("MountainCar-v0", {"preset": "solved"}),
    "hashed tile coding": ("MountainCar-v0", {"preset": "solved", "hashed_rows": 200}),
    "two tables": ("MountainCar-v0", {"algorithm": "double_q_learning", "terminal_update": "target"}),
    "integers": ("Taxi-v4", {}),
    "several integers": ("Blackjack-v1", {"initial_q": (-1.0, 1.0)}),
    "continuous actions": ("Pendulum-v1", {}),
}


@pytest.mark.parametrize(("env", "settings"), SETTINGS.values(), ids=SETTINGS)
def test_many_observations_are_answered_at_once_as_one_by_one(env, settings):
    run = qtab.train(env, seed=0, episodes=3, max_episode_steps=50, **settings)
    space = gym.make(env).observation_space
    space.seed(0)
    observations = np.array([space.sample() for _ in range(40)])
    actions, state = run.predict(observations)
    assert state is None
    values = run.q_values(observations)
    assert values.shape == (40, len(run.actions))
    for observation, action, row in zip(observations, actions, values, strict=True):
        assert row.tobytes() == run.q_values(observation).tobytes()
        assert np.array_equal(action, run.predict(observation)[0])
    assert run.q_values(observations[:0]).shape == (0, len(run.actions))
    assert len(run.predict(observations[:1])[0]) == 1


def test_the_former_name_of_the_discretizer_is_kept(run):
    assert run.grid is run.discretizer
    runs = qtab.train_many("MountainCar-v0", seeds=1, episodes=1)
    assert runs.grid is runs.discretizer


def test_a_run_can_be_copied_and_pickled(run):
    run.predict([-0.5, 0.0])
    for other in (copy.deepcopy(run), pickle.loads(pickle.dumps(run))):  # noqa: S301
        assert other.tables.tobytes() == run.tables.tobytes()
        assert other.predict([-0.5, 0.0]) == run.predict([-0.5, 0.0])


def test_mean_returns_are_those_of_whole_blocks(run):
    returns = run.episode_returns
    assert run.mean_returns(100).tolist() == [returns[:100].mean(), returns[100:200].mean()]
    assert run.mean_returns().tolist() == run.mean_returns(100).tolist()
    assert run.mean_returns(1).tolist() == returns.tolist()
    assert run.mean_returns(251).tolist() == []


@pytest.mark.parametrize(("block", "error"), [(0, ValueError), (-5, ValueError), (2.0, TypeError), (True, TypeError)])
def test_a_bad_block_is_refused(run, block, error):
    with pytest.raises(error, match=f"block must be an integer of at least 1, got {block}"):
        run.mean_returns(block)


def test_the_config_is_resolved(run):
    config = run.config
    assert (config.env, config.preset, config.backend, config.seed) == ("MountainCar-v0", "article", "rust", 0)
    assert config.max_episode_steps == 200
    assert config.episodes == 250


def test_a_config_cannot_be_changed_in_place(run):
    with pytest.raises(AttributeError):
        run.config.episodes = 3
    assert run.config.replace(episodes=3).episodes == 3
    with pytest.raises(TypeError, match="unknown setting 'colour'"):
        run.config.replace(colour="red")


def test_the_initial_table_in_a_config_is_read_only():
    run = qtab.train("MountainCar-v0", seed=0, episodes=1, initial_q=np.zeros((19, 15, 3)))
    with pytest.raises(ValueError, match="read-only"):
        run.config.initial_q[0] = 1.0  # type: ignore[index]


def test_a_run_records_the_versions_it_was_computed_with(run):
    assert {"qtab", "gymnasium", "numpy", "python", "platform", "build"} <= set(run.versions)
    assert run.versions["numpy"] == np.__version__
    assert run.versions["qtab"] == qtab.__version__


def test_presets_are_listed_per_environment():
    assert list(qtab.presets("MountainCar-v0")) == ["article", "solved"]
    assert qtab.presets("qtab/MountainCar-v0") == qtab.presets("MountainCar-v0")
    assert qtab.presets("MountainCar-v0")["article"]["terminal_update"] == "assign"
    assert list(qtab.presets("CartPole-v1")) == ["tuned", "solved"]
    assert list(qtab.presets("LunarLander-v3")) == ["solved"]
    assert dict(qtab.presets("BipedalWalker-v3")) == {}


def test_changing_the_settings_of_a_preset_changes_no_later_run() -> None:
    before = dict(qtab.presets("FrozenLake-v1")["solved"])
    qtab.presets("FrozenLake-v1")["solved"]["learning_rate"] = 0.9
    assert qtab.presets("FrozenLake-v1")["solved"] == before
    values: Any = qtab.presets("ShortCorridor-v0")["book"]["initial_q"]
    values += 1.0
    assert (qtab.presets("ShortCorridor-v0")["book"]["initial_q"] != values).all()
    run = qtab.train("FrozenLake-v1", preset="solved", seed=0, episodes=1)
    assert run.config.learning_rate == before["learning_rate"]


def test_an_explicit_setting_wins_over_the_preset():
    run = qtab.train("MountainCar-v0", preset="article", terminal_update="target", scale=(5, 50), seed=0, episodes=1)
    assert (run.config.terminal_update, run.config.scale) == ("target", (5.0, 50.0))


def test_the_repr_of_a_run_is_one_line() -> None:
    run = qtab.train("MountainCar-v0", episodes=150, seed=0)
    assert repr(run) == "<Run of MountainCar-v0: q_learning, seed 0, 150 episodes, the last 100 at -200.00>"
    runs = qtab.train_many("MountainCar-v0", seeds=3, episodes=150)
    assert repr(runs) == "<Runs of MountainCar-v0: q_learning, 3 seeds, 150 episodes each, their last 100 at -200.00>"


@pytest.mark.parametrize("use", [qtab.plot, qtab.evaluate, qtab.verify])
def test_arguments_that_are_not_runs_are_refused_by_name(use) -> None:
    with pytest.raises(TypeError, match=r"^run must be a Run, got 3$"):
        use(3)
    with pytest.raises(TypeError, match=r"^run must be a Run, got 'run.npz'; qtab.load reads one from a file$"):
        use("run.npz")


@pytest.mark.parametrize(("episodes", "block"), [(5_000, 100), (10_000, 100), (10_001, 1_000), (1_000_000, 10_000)])
def test_long_runs_are_averaged_over_more_episodes(episodes: int, block: int) -> None:
    assert default_block(episodes) == block
