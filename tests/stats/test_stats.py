"""Statistics, compared with closed forms, with SciPy and with rliable."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats as scipy_stats

import qtab
from qtab import stats
from qtab.stats.intervals import t_intervals

SAMPLE = np.random.default_rng(1).gamma(2.0, 3.0, size=60)
numbers = st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=30)


@pytest.mark.parametrize(
    ("function", "reference", "method"),
    [
        (stats.mean, np.mean, "t"),
        (stats.median, np.median, "BCa"),
        (stats.iqm, lambda values: scipy_stats.trim_mean(values, 0.25), "BCa"),
    ],
)
def test_an_estimate_lies_in_its_interval(function, reference, method):
    found = function(SAMPLE)
    assert found.estimate == reference(SAMPLE)
    assert found.method == method
    assert found.low < found.estimate < found.high
    wider = function(SAMPLE, confidence=0.999)
    assert wider.low < found.low < found.high < wider.high
    assert function(SAMPLE) == found


@pytest.mark.parametrize("function", [stats.mean, stats.median, stats.iqm])
def test_a_constant_sample_has_the_interval_of_its_one_value(function):
    assert function([3.0] * 7) == stats.Interval(3.0, 3.0, 3.0, 0.95, "constant")
    assert function([0.1] * 7).method == "constant"
    with pytest.raises(ValueError, match=r"^values must hold at least 2 numbers for an interval, got 1$"):
        function([3.0])


@pytest.mark.parametrize("runs", [2, 5, 29, 30, 400])
def test_the_interval_of_the_mean_is_students_for_any_number_of_runs(runs):
    values = np.random.default_rng(0).gamma(2.0, 3.0, size=runs)
    found = stats.mean(values, confidence=0.9)
    expected = scipy_stats.t.interval(0.9, runs - 1, values.mean(), scipy_stats.sem(values))
    assert (found.method, found.confidence) == ("t", 0.9)
    assert (found.low, found.high) == pytest.approx(expected)
    assert stats.curve(values[:, np.newaxis], block=1, confidence=0.9) == [found]
    assert stats.compare(values, 0 * values, confidence=0.9, resamples=9).difference == found


def test_two_runs_have_a_wide_interval():
    found = stats.mean([1.0, 2.0])
    assert found.low < -4
    assert found.high > 7


@pytest.mark.parametrize("runs", [5, 10, 30, 50])
def test_the_interval_of_the_mean_covers_what_it_claims(runs):
    # The bootstrap's covered 83 %, 91 %, 93.7 % and 93.2 %.
    samples = np.random.default_rng(0).normal(3.0, 2.0, size=(runs, 20_000))
    assert np.mean([interval.low <= 3.0 <= interval.high for interval in t_intervals(samples, 0.95)]) > 0.945


def test_where_bca_is_not_finite_the_percentile_interval_is_used_and_reported():
    # Nearly every resample has the median of the sample, so that the bias cannot be estimated.
    found = stats.median([0.0] * 99 + [1.0])
    assert found.method == "percentile"
    assert (found.low, found.high) == (0.0, 0.0)


@settings(max_examples=25, deadline=None)
@given(values=numbers)
def test_an_interval_is_finite_and_in_order(values):
    for function in (stats.mean, stats.median, stats.iqm):
        found = function(values, resamples=99)
        assert np.isfinite([found.estimate, found.low, found.high]).all()
        assert found.low <= found.high
        if found.method != "t":  # which does not know that returns may have bounds
            assert min(values) - 1e-6 <= found.low
            assert found.high <= max(values) + 1e-6


def test_a_tolerance_interval_has_its_nominal_coverage():
    rng = np.random.default_rng(3)
    covered = 0
    for _ in range(400):
        found = stats.tolerance_interval(rng.normal(size=60), coverage=0.8, confidence=0.9)
        covered += scipy_stats.norm.cdf(found.high) - scipy_stats.norm.cdf(found.low) >= 0.8
    assert covered / 400 >= 0.87


def test_the_smallest_sample_for_a_tolerance_interval_is_wilks():
    # 46 values are known to be the fewest whose range covers 90 % with confidence 95 %.
    found = stats.tolerance_interval(np.arange(46.0))
    assert (found.low, found.high) == (0.0, 45.0)
    with pytest.raises(ValueError, match=r"values must hold at least 46 numbers .* got 45"):
        stats.tolerance_interval(np.arange(45.0))


def test_the_solved_rate_has_wilsons_interval():
    found = stats.solved_rate([-110.0] * 3 + [-90.0, -110.0001] + [-200.0] * 5, threshold=-110)
    z = scipy_stats.norm.ppf(0.975)
    share, count = 0.4, 10
    middle = (share + z**2 / (2 * count)) / (1 + z**2 / count)
    half = z / (1 + z**2 / count) * np.sqrt(share * (1 - share) / count + z**2 / (4 * count**2))
    assert found.estimate == share
    assert found.low == pytest.approx(middle - half)
    assert found.high == pytest.approx(middle + half)
    none = stats.rate(0, 20)
    assert none.low == 0 < none.high < 1


def test_the_area_is_the_mean_return():
    assert stats.area_under_curve([[0.0, 2.0], [4.0, 4.0]]).tolist() == [1.0, 4.0]


def test_episodes_to_threshold_uses_whole_windows():
    returns = [[0, 0, 1, 1, 1], [0, 0, 0, 0, 0], [1, 1, 0, 0, 0]]
    assert stats.episodes_to_threshold(returns, 1.0, window=2).tolist() == [4, np.inf, 2]
    assert stats.episodes_to_threshold(returns, 0.5, window=2).tolist() == [3, np.inf, 2]


def test_a_curve_has_an_interval_per_block():
    runs = qtab.train_many("MountainCar-v0", 8, episodes=250)
    curve = stats.curve(runs.episode_returns, block=100, resamples=99)
    assert [point.estimate for point in curve] == runs.mean_returns(100).mean(axis=0).tolist()


def test_a_paired_comparison_detects_a_consistent_difference():
    rng = np.random.default_rng(5)
    luck = rng.normal(0, 10, size=40)
    a, b = luck + rng.normal(1, 0.5, size=40), luck
    found = stats.compare(a, b)
    assert 0.7 < found.difference.low < found.difference.estimate < found.difference.high < 1.3
    assert found.effect_size is not None
    assert found.effect_size == pytest.approx(np.mean(a - b) / np.std(a - b, ddof=1))
    assert found.p_value < 0.001
    assert found.better > 0.9
    unpaired = scipy_stats.ttest_ind(a, b)
    assert unpaired.pvalue > 0.05
    mirrored = stats.compare(b, a)
    assert mirrored.effect_size == -found.effect_size
    assert mirrored.p_value == found.p_value


def test_the_permutation_test_of_few_pairs_is_exact():
    # Of the 2**4 ways of swapping, two give a mean difference as large as all four of one sign.
    assert stats.compare([1.0, 2.0, 3.0, 4.0], [0.0, 0.0, 0.0, 0.0]).p_value == 2 / 16


def test_equal_samples_do_not_differ():
    found = stats.compare(SAMPLE, SAMPLE)
    assert (found.difference.estimate, found.effect_size, found.better, found.p_value) == (0, 0, 0.5, 1)


def test_a_constant_difference_has_no_effect_size_and_reports_it():
    found = stats.compare([1.0, 2.0, 3.0], [2.0, 3.0, 4.0])
    assert found.effect_size is None
    assert "no effect size (all 3 differences are equal)" in str(found)


def test_too_few_pairs_for_a_significant_difference_are_reported():
    found = stats.compare([1.0, 2.0, 4.0], [0.0, 0.0, 0.0])
    assert found.p_value == found.smallest_p_value == 0.25
    assert str(found).endswith("p = 0.25 (at least 0.25 with 3 pairs: too few for a significant one)")
    assert "too few" not in str(stats.compare(SAMPLE, SAMPLE + 1))


@pytest.mark.parametrize("resamples", [9, 63, 64, 65, 999])
@pytest.mark.parametrize("pairs", [2, 6, 40])
def test_the_smallest_p_value_is_reached_where_all_differences_have_one_sign(pairs, resamples):
    found = stats.compare(np.arange(1.0, pairs + 1), np.zeros(pairs), resamples=resamples)
    exact = 2**pairs <= resamples
    assert found.smallest_p_value == 2 / (2**pairs if exact else resamples + 1)
    # A random permutation of few pairs may also swap all of them or none.
    assert found.p_value == found.smallest_p_value if exact or pairs == 40 else found.p_value >= found.smallest_p_value


def test_too_few_permutations_for_a_significant_difference_are_reported():
    found = stats.compare(SAMPLE, SAMPLE + 1, resamples=9)
    assert str(found).endswith("(at least 0.2 with 9 permutations: too few for a significant one)")
    assert "at least 0.2 with 9 permutations" in found._repr_html_()


def test_a_profile_is_the_same_in_blocks(monkeypatch):
    levels = np.linspace(0, 20, 9)
    whole = stats.profile({"a": SAMPLE, "b": SAMPLE[:7]}, levels, resamples=300)
    monkeypatch.setattr("qtab.stats.profiles.BATCH_VALUES", 600)
    assert stats.profile({"a": SAMPLE, "b": SAMPLE[:7]}, levels, resamples=300) == whole


def test_the_probability_of_improvement_counts_ties_half():
    assert stats.probability_of_improvement([1.0, 2.0], [1.0, 0.0]).estimate == (0.5 + 1 + 1 + 1) / 4
    assert stats.probability_of_improvement([3.0, 3.0], [1.0, 1.0]).method == "constant"


@pytest.mark.parametrize(
    ("single", "several"),
    [
        (lambda sample: stats.aggregate(sample, "mean", resamples=9).estimate, np.mean),
        (lambda sample: stats.aggregate(sample, "median", resamples=9).estimate, np.median),
        (lambda sample: stats.optimality_gap(sample, resamples=9).estimate, np.mean),
        (lambda sample: stats.performance_profile(sample, [0.7])[0], np.mean),
        (lambda sample: stats.profile(sample, [0.7], resamples=9)[0].estimate, np.mean),
        (lambda sample: stats.probability_of_improvement(sample, sample, resamples=9).estimate, np.mean),
    ],
)
def test_every_environment_counts_the_same_whatever_its_number_of_runs(single, several):
    rng = np.random.default_rng(0)
    samples = {"few": rng.beta(5, 1, size=5), "many": rng.beta(2, 2, size=50), "some": rng.beta(2, 5, size=7)}
    expected = several([single({name: sample}) for name, sample in samples.items()])
    assert single(samples) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("counts", [(2, 2), (5, 50), (4, 8, 16), (3, 5, 7, 11), (9, 10)])
def test_the_interquartile_mean_of_unequal_numbers_of_runs_weighs_them(counts):
    rng = np.random.default_rng(sum(counts))
    few = [rng.normal(index, 1.0, size=count) for index, count in enumerate(counts)]
    found = stats.aggregate({str(index): sample for index, sample in enumerate(few)}, resamples=9)
    copies = np.lcm.reduce(counts)
    repeated = [np.repeat(sample, copies // len(sample)) for sample in few]
    lowest, highest = np.sort(np.concatenate(repeated))[[len(few) * copies // 4, -(len(few) * copies // 4) - 1]]
    kept = np.concatenate([sample[(sample >= lowest) & (sample <= highest)] for sample in repeated])
    assert found.estimate == pytest.approx(kept.mean(), abs=1e-12)
    assert found.low <= found.estimate <= found.high


def test_environments_may_have_different_numbers_of_runs():
    found = stats.aggregate({"a": [1.0, 2.0, 3.0], "b": [5.0, 5.5]}, "mean")
    assert found.estimate == (2 + 5.25) / 2
    assert 3 <= found.low <= found.high <= 4.25
    assert stats.aggregate({"a": [1.0, 1.0], "b": [5.0, 5.0]}, "mean").method == "constant"


@pytest.mark.parametrize(
    ("function", "call"),
    [
        ("bootstrap", lambda: stats.median(SAMPLE, resamples=10**6)),
        ("bootstrap", lambda: stats.aggregate({"a": SAMPLE, "b": SAMPLE}, resamples=10**6)),
        ("permutation_test", lambda: stats.compare(SAMPLE, SAMPLE[::-1], resamples=10**6)),
    ],
)
def test_many_resamples_are_drawn_in_blocks(function, call, monkeypatch):
    batches = []

    def record(*_, batch, **__):
        batches.append(batch)
        raise InterruptedError

    monkeypatch.setattr(scipy_stats, function, record)
    with pytest.raises(InterruptedError):
        call()
    assert 1000 < batches[0] * len(SAMPLE) <= 2**22
