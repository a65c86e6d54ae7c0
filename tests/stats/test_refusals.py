"""Bad input of the statistics is refused by name and value."""

from typing import Any

import numpy as np
import pytest

import qtab
from qtab import stats

RUNS: Any = qtab.train_many("MountainCar-v0", 2, episodes=3)
SAMPLE = np.random.default_rng(1).gamma(2.0, 3.0, size=60)


BAD = [[1.0, np.nan, np.inf, 2.0], [1.0, None, -np.inf, 2.0]]


@pytest.mark.parametrize("values", BAD)
@pytest.mark.parametrize(
    ("call", "name"),
    [
        (stats.mean, "values"),
        (stats.median, "values"),
        (stats.iqm, "values"),
        (stats.tolerance_interval, "values"),
        (lambda bad: stats.solved_rate(bad, 0), "returns"),
        (lambda bad: stats.compare(bad, [0.0] * 4), "a"),
        (lambda bad: stats.compare([0.0] * 4, bad), "b"),
        (lambda bad: stats.probability_of_improvement([0.0] * 4, bad), "b"),
        (stats.area_under_curve, "returns"),
        (lambda bad: stats.curve([bad, bad], block=2), "returns"),
        (lambda bad: stats.episodes_to_threshold(bad, 0, window=2), "returns"),
        (lambda bad: stats.aggregate({"a": bad}), r"scores\['a'\]"),
        (lambda bad: stats.optimality_gap([bad]), "scores"),
        (lambda bad: stats.performance_profile([bad], [0]), "scores"),
        (lambda bad: stats.performance_profile([[1.0]], bad), "thresholds"),
        (lambda bad: stats.profile({"a": bad}, [0]), r"scores\['a'\]"),
    ],
)
def test_numbers_that_are_not_finite_are_refused_and_counted(call, name, values):
    with pytest.raises(ValueError, match=rf"^{name} must be finite, got [24] of [48] NaN or infinite"):
        call(values)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: stats.mean([]), ValueError, "values must hold at least 2 numbers for an interval, got 0"),
        (lambda: stats.mean([[1.0, 2.0]]), ValueError, "values must be one-dimensional, with one number per run"),
        (lambda: stats.mean([1e300, 2.0]), ValueError, r"values must lie between -1e\+150 and 1e\+150"),
        (lambda: stats.mean([1.0, 2j]), TypeError, "values must hold numbers"),
        (lambda: stats.mean(np.array([1.0, 2j])), TypeError, "values must hold numbers"),
        (lambda: stats.mean(["1", "2"]), TypeError, "values must hold numbers"),
        (lambda: stats.mean([10**400, 2]), TypeError, "values must hold numbers"),
        (lambda: stats.mean([[1.0], [1.0, 2.0]]), TypeError, "values must hold numbers"),
        (lambda: stats.mean([1.0, 2.0], confidence=1), ValueError, "confidence must be greater than 0 and less than 1"),
        (lambda: stats.mean(SAMPLE, resamples=10**12), ValueError, "resamples must be an integer from 1 to 1000000"),
        (lambda: stats.aggregate([[1.0], [2.0]], resamples=10**12), ValueError, "resamples must be an integer from 1"),
        (lambda: stats.compare([1, 2], [2, 1], resamples=10**12), ValueError, "resamples must be an integer from 1"),
        (lambda: stats.curve([1.0, 2.0]), ValueError, "returns must hold at least 2 runs for an interval, got 1"),
        (lambda: stats.area_under_curve([]), ValueError, "returns must have the shape .* and not be empty"),
        (lambda: stats.solved_rate([], 0), ValueError, "returns must hold at least 1 number, got 0"),
        (lambda: stats.probability_of_improvement([1, 2], [[1, 2]] * 2), ValueError, "a and b must have the same env"),
        (lambda: stats.mean(RUNS), TypeError, r"got <Runs .*; its episode_returns and final_returns\(\) do"),
        (lambda: stats.mean("abc"), TypeError, "values must hold numbers"),
        (lambda: stats.mean([1.0, 2.0], confidence=2), ValueError, "confidence must lie in"),
        (lambda: stats.mean([1.0, 2.0], resamples=0), ValueError, "resamples must be an integer from 1 to"),
        (lambda: stats.rate(3, 2), ValueError, "successes must be an integer from 0 to 2"),
        (lambda: stats.compare([1.0, 2.0], [1.0]), ValueError, "b must hold at least 2 numbers for an interval, got 1"),
        (lambda: stats.compare([1.0, 2.0], [1.0, 2.0, 3.0]), ValueError, "must have the same length, got 2 and 3"),
        (lambda: stats.aggregate({}), ValueError, "at least one environment"),
        (lambda: stats.aggregate([1.0, 2.0]), ValueError, "the shape"),
        (lambda: stats.aggregate([[1.0]]), ValueError, "scores must hold at least 2 numbers for an interval, got 1"),
        (lambda: stats.aggregate([[1.0]], "mode"), ValueError, "statistic must be one of"),
        (lambda: stats.episodes_to_threshold([1.0, 2.0], 0, window=3), ValueError, "window must be"),
    ],
)
def test_bad_input_is_refused_by_name(call, error, message):
    with pytest.raises(error, match=message):
        call()
