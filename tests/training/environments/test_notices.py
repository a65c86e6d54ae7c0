"""What is logged once: a default time limit, and the version of an id that has none."""

import logging

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.training.setup import resolved_run
from support.environments import ScriptedEnv

UNLIMITED = "CliffWalking-v1 has no time limit: an episode ends after 10,000 steps"


@pytest.fixture
def said(caplog, monkeypatch):
    """The messages of the logger ``qtab``, as in a process that has logged nothing yet."""
    monkeypatch.setattr(resolved_run, "_logged", set())
    caplog.set_level(logging.DEBUG, logger="qtab")
    return lambda: caplog.messages


def test_the_default_time_limit_is_logged_once_per_environment(said):
    for _ in range(2):
        run = qtab.train("CliffWalking-v1", episodes=2, seed=0)
    assert run.config.max_episode_steps == 10_000
    assert said() == [f"{UNLIMITED}; max_episode_steps= sets another"]
    qtab.train(ScriptedEnv([np.array([1.0], np.float32)]), scale=(1,), episodes=1, progress=False)
    assert [line.split()[0] for line in said()] == ["CliffWalking-v1", "ScriptedEnv"]


def test_train_many_logs_the_default_time_limit_once(said):
    qtab.train_many("CliffWalking-v1", seeds=3, episodes=2)
    qtab.sweep("CliffWalking-v1", {"learning_rate": [0.1, 0.2]}, seeds=2, episodes=2)
    assert said() == [f"{UNLIMITED}; max_episode_steps= sets another"]


def test_a_given_time_limit_is_not_logged(said):
    run = qtab.train("CliffWalking-v1", episodes=2, max_episode_steps=50, seed=0)
    qtab.train("MountainCar-v0", episodes=1)
    qtab.train(gym.wrappers.TimeLimit(gym.make("CliffWalking-v1"), 50), episodes=1)
    qtab.evaluate(run, episodes=2)
    assert said() == []


def warning_of(call):
    """The one warning of a call, and what it returned."""
    with pytest.warns(UserWarning, match="unversioned environment") as caught:
        result = call()
    return {str(warning.message) for warning in caught}, result


@pytest.mark.parametrize("env", ["MountainCar", "qtab/MountainCar", "qtab:qtab/MountainCar"])
def test_an_id_without_a_version_means_the_newest_with_gymnasiums_warning(env):
    theirs, _ = warning_of(lambda: gym.make(env))
    ours, run = warning_of(lambda: qtab.train(env, episodes=2, seed=0))
    assert ours == theirs
    assert run.config.env == f"{env}-v0"
    assert run.q_table.tobytes() == qtab.train("MountainCar-v0", episodes=2, seed=0).q_table.tobytes()


def test_train_many_uses_the_newest_version():
    _, runs = warning_of(lambda: qtab.train_many("Taxi", seeds=2, episodes=2))
    assert runs.config.env == "Taxi-v4"
    _, table = warning_of(lambda: qtab.sweep("Taxi", {"learning_rate": [0.1]}, seeds=2, episodes=2))
    assert len(table) == 2


def test_the_newest_version_has_its_preset():
    _, run = warning_of(lambda: qtab.train("Taxi", episodes=2))
    assert run.config.preset == "tuned"


@pytest.mark.parametrize("env", ["NoSuchThing", "NoSuchThing-v0", "nowhere/MountainCar", "Mountain Car"])
def test_an_unknown_id_raises_gymnasiums_error(env):
    with pytest.raises(gym.error.Error) as theirs:
        gym.spec(env)
    with pytest.raises(type(theirs.value)) as ours:
        qtab.train(env)
    assert str(ours.value) == str(theirs.value)
