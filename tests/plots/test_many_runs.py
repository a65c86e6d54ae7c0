"""Plots of many runs show the numbers that they are made from."""

from typing import Any

import numpy as np
import pytest

import qtab
from qtab import plots, stats

RETURNS = np.cumsum(np.random.default_rng(0).normal(1, 5, size=(12, 300)), axis=1)
GRID: dict[str, Any] = {
    "learning_rate": [0.01, 0.1, 1.0],
    "epsilon": [0.1, 0.9],
    "terminal_update": ["assign", "target"],
}
STUDY = qtab.sweep("MountainCar-v0", GRID, seeds=3, episodes=30)


def lines(ax):
    return {line.get_label(): line for line in ax.get_lines()}


def legend_title(ax):
    return ax.get_legend().get_title().get_text().replace("\n", " ")


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


def test_sensitivity_shows_the_best_of_the_other_settings_and_colours_by_a_second():
    ax = plots.sensitivity(STUDY, "learning_rate", by="epsilon", column="mean_return")
    assert ax.get_xscale() == "log"
    frame = STUDY.to_pandas()
    means = frame[frame.epsilon == 0.9].groupby(["learning_rate", "terminal_update"])["mean_return"].mean()
    shown = lines(ax)["epsilon = 0.9"]
    np.testing.assert_allclose(shown.get_ydata(), means.groupby("learning_rate").max().to_numpy())
    assert "best terminal_update for each point" in legend_title(ax)
    named = plots.sensitivity(STUDY, "terminal_update")
    assert [text.get_text() for text in named.get_xticklabels()] == ["assign", "target"]


def test_the_interval_of_a_sensitivity_is_over_the_seeds_of_one_setting():
    ax = plots.sensitivity(STUDY, "learning_rate", fixed={"epsilon": 0.9, "terminal_update": "target"})
    assert "epsilon = 0.9, terminal_update = target" in legend_title(ax)
    assert "best" not in legend_title(ax)
    settings = [
        setting
        for setting, values in enumerate(STUDY.settings)
        if (values["epsilon"], values["terminal_update"]) == (0.9, "target")
    ]
    intervals = [stats.mean(STUDY.values("final_return", setting)) for setting in settings]
    corners: Any = ax.collections[0].get_paths()[0].vertices
    for rate, interval in zip((0.01, 0.1, 1.0), intervals, strict=True):
        assert {interval.low, interval.high} <= set(corners[corners[:, 0] == rate, 1])


def test_a_sensitivity_of_one_seed_has_no_interval():
    one = qtab.sweep("MountainCar-v0", {"discount": [0.5, 0.9]}, seeds=1, episodes=5, max_episode_steps=20)
    ax = plots.sensitivity(one, "discount", threshold=-110, optimum=-97)
    assert not any(np.isfinite(np.array(path.vertices)[:, 1]).any() for path in ax.collections[0].get_paths())
    assert "threshold -110" in lines(ax)
    assert "optimum -97" in lines(ax)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (("alpha",), ValueError, "parameter must be one of 'learning_rate', 'epsilon', 'terminal_update', got 'alpha'"),
        (("epsilom",), ValueError, r"got 'epsilom' \(did you mean 'epsilon'\?\)"),
        ((3,), TypeError, "parameter must be one of .* got 3"),
        (("epsilon", None, {"by": "epsilon"}), ValueError, "by must be another parameter than 'epsilon'"),
        (("epsilon", None, {"column": "final_returns"}), ValueError, r"column .* \(did you mean 'final_return'\?\)"),
        (("epsilon", None, {"column": "error"}), ValueError, "column must be one of"),
        (("epsilon", None, {"statistic": "mode"}), ValueError, "statistic must be one of"),
        (("epsilon", None, {"fixed": 3}), TypeError, "fixed must map names of parameters to values, got 3"),
        (("epsilon", None, {"fixed": {"learning_rates": 1}}), ValueError, r"\(did you mean 'learning_rate'\?\)"),
        (("epsilon", None, {"fixed": {"epsilon": 0.1}}), ValueError, "a name in fixed must be one of"),
        (("epsilon", None, {"fixed": {"learning_rate": 0.2}}), ValueError, r"must be one of 0.01, 0.1, 1, got 0.2"),
    ],
)
def test_a_bad_sensitivity_is_refused_by_name(arguments, error, message):
    parameter, ax, options = (*arguments, None, {})[:3] if len(arguments) == 1 else arguments
    with pytest.raises(error, match=message):
        plots.sensitivity(STUDY, parameter, ax, **options)
    with pytest.raises(TypeError, match="sweep must be a Sweep, got 3"):
        plots.sensitivity(3, parameter)  # type: ignore[arg-type]


def test_a_profile_has_the_intervals_of_its_statistic():
    scores = {"a": RETURNS[:, -1], "b": RETURNS[:, 0]}
    levels = np.linspace(-50, 50, 5)
    ax = plots.profile(scores, thresholds=levels)
    band: Any = ax.collections[0].get_paths()[0].vertices
    for point in stats.profile({"": scores["a"]}, levels):
        assert {point.low, point.high} <= set(band[:, 1])
    assert len(plots.profile({"a": [1.0]}).collections) == 0


def test_a_profile_falls_from_all_to_none():
    ax = plots.profile({"a": RETURNS[:, :5]})
    shares = lines(ax)["a"].get_ydata()
    assert (shares[0], shares[-1]) == (1, 0)
    assert (np.diff(shares) <= 0).all()


def test_a_distribution_counts_every_run():
    ax = plots.distribution(RETURNS[:, -1], bins=5)
    bars = ax.containers[0]
    assert len(bars) == 5
    assert sum(bar.get_height() for bar in bars) == 12


@pytest.mark.parametrize("draw", [plots.learning_curves, plots.distribution, plots.profile])
def test_lines_differ_in_their_style_as_well_as_in_their_color(draw: Any) -> None:
    named = {
        name: RETURNS + index if draw is plots.learning_curves else RETURNS[:, -1] + index
        for index, name in enumerate("abcde")
    }
    ax = draw(named, colors="black")
    lines = [line for line in ax.lines if line.get_linewidth() >= 2]
    assert len(lines) == 5
    assert len({str(line._unscaled_dash_pattern) for line in lines}) == 5
    assert lines[0].get_linestyle() == "-"


def test_lines_of_several_calls_differ_in_their_style() -> None:
    ax = plots.learning_curves(RETURNS, label="a")
    plots.learning_curves(RETURNS, ax, label="b", index=1)
    thick = [line for line in ax.lines if line.get_linewidth() > 2]
    assert [line.get_linestyle() for line in thick] == ["-", "--"]
