"""Aggregates, profiles and probabilities of improvement, compared with rliable."""

import numpy as np
import pytest

from qtab import stats

STATISTICS = ("mean", "median", "iqm")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")  # rliable's imports warn
def test_aggregates_match_rliable():
    from rliable import library, metrics

    scores = np.random.default_rng(2).beta(2, 5, size=(10, 5)) * np.arange(1, 6)
    theirs = [getattr(metrics, f"aggregate_{statistic}") for statistic in STATISTICS]
    points, intervals = library.get_interval_estimates(
        {"x": scores},
        lambda table: np.array([aggregate(table) for aggregate in theirs]),
        reps=1000,
        random_state=np.random.RandomState(1),
    )
    for index, statistic in enumerate(STATISTICS):
        found = stats.aggregate(scores, statistic)
        assert found.estimate == pytest.approx(points["x"][index], abs=1e-12)
        width = found.high - found.low
        assert found.low == pytest.approx(intervals["x"][0, index], abs=0.1 * width)
        assert found.high == pytest.approx(intervals["x"][1, index], abs=0.1 * width)
        by_name = stats.aggregate({f"task {index}": column for index, column in enumerate(scores.T)}, statistic)
        assert by_name == found


@pytest.mark.slow  # whichever test comes first imports rliable, which takes seconds: all of them in one process
@pytest.mark.filterwarnings("ignore")
def test_optimality_gap_and_performance_profile_match_rliable():
    from rliable import library, metrics

    scores = np.random.default_rng(2).beta(2, 2, size=(12, 4)) * 1.5
    assert stats.optimality_gap(scores).estimate == pytest.approx(metrics.aggregate_optimality_gap(scores), abs=1e-12)
    levels = np.linspace(0, 1.5, 7)
    theirs, _ = library.create_performance_profile({"x": scores}, levels, reps=10)
    assert stats.performance_profile(scores, levels) == pytest.approx(theirs["x"], abs=1e-12)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_intervals_of_a_profile_match_rliable():
    from rliable import library

    scores = np.random.default_rng(2).beta(2, 2, size=(12, 4)) * 1.5
    levels = np.linspace(0.1, 1.4, 7)
    _, theirs = library.create_performance_profile({"x": scores}, levels, reps=2000)
    found = stats.profile(scores, levels)
    assert [point.estimate for point in found] == stats.performance_profile(scores, levels).tolist()
    # In steps of 1/48, the quantiles of two bootstraps may differ by one step.
    assert [point.low for point in found] == pytest.approx(theirs["x"][0], abs=1.01 / 48)
    assert [point.high for point in found] == pytest.approx(theirs["x"][1], abs=1.01 / 48)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_the_probability_of_improvement_matches_rliable():
    from rliable import library, metrics

    rng = np.random.default_rng(4)
    x, y = rng.normal(0.3, 1, size=(9, 3)).round(1), rng.normal(0, 1, size=(7, 3)).round(1)
    points, intervals = library.get_interval_estimates(
        {"x,y": (x, y)}, metrics.probability_of_improvement, reps=300, random_state=np.random.RandomState(1)
    )
    found = stats.probability_of_improvement(x, y)
    assert found.estimate == pytest.approx(points["x,y"], abs=1e-12)
    bounds = np.ravel(intervals["x,y"])
    assert (found.low, found.high) == pytest.approx(bounds, abs=0.15 * (found.high - found.low))
    named = [{f"task {index}": column for index, column in enumerate(scores.T)} for scores in (x, y)]
    assert stats.probability_of_improvement(*named) == found
