"""The preset that solves MountainCar-v0."""

import numpy as np

import qtab


def test_every_seed_solves_mountain_car_and_together_they_end_above_minus_106():
    runs = [qtab.train("MountainCar-v0", preset="solved", seed=seed) for seed in range(20)]
    for run in runs:
        averages = np.convolve(run.episode_returns, np.full(100, 0.01), "valid")
        assert averages.max() >= -110, run.config.seed
    assert np.mean([run.mean_returns(100)[-1] for run in runs]) > -106


def test_the_solved_preset_is_what_numpy_computes():
    run = qtab.train("MountainCar-v0", preset="solved", seed=0)
    assert qtab.verify(run, episodes=5).equal
