"""The presets solve classic control by Gymnasium's thresholds."""

import gymnasium as gym
import numpy as np
import pytest

import qtab

SOLVED = {
    "CartPole-v0": ("tuned", 2, 195.0),
    "CartPole-v1": ("solved", 1, 500.0),
    "Acrobot-v1": ("solved", 1, -90.0),
    "MountainCarContinuous-v0": ("solved", 2, 90.0),
}
"""For each environment: the preset, the number of seeds, and the least mean return of their last 100 episodes."""


def best_average(run: qtab.Run) -> float:
    """The best mean return of 100 consecutive episodes."""
    return float(np.convolve(run.episode_returns, np.full(100, 0.01), "valid").max())


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*out of date")
@pytest.mark.parametrize("env", SOLVED)
def test_every_seed_solves_its_environment_and_the_mean_ends_above_the_threshold(env: str) -> None:
    preset, seeds, least = SOLVED[env]
    runs = [qtab.train(env, preset=preset, seed=seed) for seed in range(seeds)]
    threshold = gym.spec(env).reward_threshold
    assert threshold is not None
    for run in runs:
        assert best_average(run) >= threshold, run.config.seed
    assert np.mean([run.mean_returns(100)[-1] for run in runs]) >= least


def test_pendulum_learns_to_balance() -> None:
    # Balancing costs about 140; hanging down costs 1,200 and more.
    assert qtab.train("Pendulum-v1", seed=0).mean_returns(100)[-1] > -180


def test_the_default_preset_of_cart_pole_is_a_grid_that_solves_it() -> None:
    run = qtab.train("CartPole-v1", seed=0)
    assert run.config.preset == "tuned"
    assert run.q_table.shape == (3, 3, 6, 6, 2)
    assert best_average(run) >= 475


@pytest.mark.slow
@pytest.mark.parametrize("env", ["CartPole-v1", "MountainCarContinuous-v0"])
def test_the_presets_verify(env: str) -> None:
    run = qtab.train(env, preset=SOLVED[env][0], seed=0)
    assert qtab.verify(run, episodes=1).equal
