"""Configs are equal if all of their settings are, also after saving and loading."""

import numpy as np
import pytest

import qtab


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"initial_q": np.zeros((16, 4))},
        {"initial_q": (0.0, 1.0)},
        {"env_kwargs": {"desc": ("SFFF", "FHFH", "FFFH", "HFFG")}},
        {"algorithm": "dyna_q", "planning_steps": 3},
    ],
    ids=str,
)
def test_the_config_of_a_loaded_run_is_that_of_the_saved_one(tmp_path, settings):
    run = qtab.train("FrozenLake-v1", seed=0, episodes=2, **settings)
    run.save(tmp_path / "run.npz")
    config = qtab.load(tmp_path / "run.npz").config
    assert config == run.config
    assert hash(config) == hash(run.config)
    assert len({config, run.config}) == 1


@pytest.mark.parametrize(
    "changes",
    [{"seed": 1}, {"discount": 0.5}, {"env_kwargs": {"is_slippery": False}}, {"initial_q": np.zeros((16, 4))}],
    ids=str,
)
def test_configs_that_differ_in_a_setting_are_not_equal(changes):
    config = qtab.Config("FrozenLake-v1", seed=0)
    assert config != config.replace(**changes)
    assert config != vars(config)


def test_arrays_are_compared_by_their_bytes():
    zeros = qtab.Config(initial_q=np.zeros((2, 3)))
    assert zeros == qtab.Config(initial_q=np.zeros((2, 3)))
    assert hash(zeros) == hash(qtab.Config(initial_q=np.zeros((2, 3))))
    assert zeros != qtab.Config(initial_q=-np.zeros((2, 3)))
    assert zeros != qtab.Config(initial_q=np.zeros((3, 2)))
    assert zeros != qtab.Config(initial_q=0.0)
