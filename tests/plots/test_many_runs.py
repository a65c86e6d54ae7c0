"""Plots of many runs show the numbers that they are made from."""

from typing import Any

import numpy as np
import pytest

import qtab
from qtab import plots, stats

RETURNS = np.cumsum(np.random.default_rng(0).normal(1, 5, size=(12, 300)), axis=1)


def lines(ax):
    return {line.get_label(): line for line in ax.get_lines()}


def test_learning_curves_show_the_mean_its_interval_and_every_run():
    ax = plots.learning_curves(RETURNS, block=50, title="t")
    points = stats.curve(RETURNS, block=50)
    mean = lines(ax)["mean of 12 runs, 95% interval"]
    assert mean.get_xdata().tolist() == [50, 100, 150, 200, 250, 300]
    assert mean.get_ydata().tolist() == [point.estimate for point in points]
    assert len(ax.get_lines()) == 12 + 1
    (band,) = ax.collections
    assert band.get_paths()[0].get_extents().ymax == max(point.high for point in points)


def test_every_function_draws_on_the_axes_it_is_given():
    from matplotlib.figure import Figure

    study = qtab.sweep("MountainCar-v0", {"discount": [0.5, 0.9]}, seeds=4, episodes=20)
    axes = Figure().subplots(2, 2).ravel()
    assert plots.learning_curves(RETURNS, axes[0]) is axes[0]
    assert plots.distribution({"a": RETURNS[0], "b": RETURNS[1]}, axes[1], threshold=3.0) is axes[1]
    assert plots.profile({"a": RETURNS[0], "b": RETURNS[1]}, axes[2]) is axes[2]
    assert plots.sensitivity(study, "discount", axes[3]) is axes[3]
    for ax in axes:
        assert ax.get_xlabel()
        assert ax.get_ylabel()


def test_sensitivity_pools_the_other_settings_and_colours_by_a_second():
    grid: dict[str, Any] = {
        "learning_rate": [0.01, 0.1, 1.0],
        "epsilon": [0.1, 0.9],
        "terminal_update": ["assign", "target"],
    }
    study = qtab.sweep("MountainCar-v0", grid, seeds=3, episodes=30)
    ax = plots.sensitivity(study, "learning_rate", by="epsilon", column="mean_return")
    assert ax.get_xscale() == "log"
    frame = study.to_pandas()
    means = frame[frame.epsilon == 0.9].groupby("learning_rate")["mean_return"].mean()
    np.testing.assert_allclose(lines(ax)["epsilon = 0.9"].get_ydata(), means.to_numpy())
    named = plots.sensitivity(study, "terminal_update")
    assert [text.get_text() for text in named.get_xticklabels()] == ["assign", "target"]
    with pytest.raises(KeyError):
        plots.sensitivity(study, "discount")


def test_a_profile_falls_from_all_to_none():
    ax = plots.profile({"a": RETURNS})
    shares = lines(ax)["a"].get_ydata()
    assert shares[-1] == 0
    assert (np.diff(shares) <= 0).all()


def test_a_distribution_counts_every_run():
    ax = plots.distribution(RETURNS[:, -1], bins=5)
    bars = ax.containers[0]
    assert len(bars) == 5
    assert sum(bar.get_height() for bar in bars) == 12
