"""The figures of chapters 3, 4 and 8.7, 8.8: their numbers beside the book's, their tables and their pictures."""

import dataclasses
import functools

import numpy as np
import pytest

import qtab
from qtab.book.experiment import ExactExperiment
from qtab.book.figures.chapter_08.figure_8_8 import Tasks, UpdateDistributions

EXACT = [
    pytest.param(name, marks=[pytest.mark.slow] * (name == "figure-4.2"))  # millions of transitions
    for name, one in qtab.book.EXPERIMENTS.items()
    if isinstance(one, ExactExperiment)
]
SEVERAL_AXES = {"example-3.5": 1, "example-3.8": 2, "figure-4.1": 12, "figure-4.2": 7, "figure-4.3": 2}


@functools.cache
def computed(name):
    return qtab.book.run(name, runs=5, seed=3)


def lines(number):
    return {line.name: line for line in computed(f"figure-{number}").lines}


@pytest.mark.parametrize("name", EXACT)
def test_a_computed_figure_has_a_table_and_a_picture(name, tmp_path):
    result = computed(name)
    assert "computed, without random numbers" in str(result)
    assert "std. error" not in str(result)
    assert [line.name for line in result.lines] == list(result.experiment.line_names)
    result.save(tmp_path / "points.csv")
    assert len((tmp_path / "points.csv").read_text().splitlines()) == 1 + sum(len(line.x) for line in result.lines)
    figure = result.plot().figure
    if name in SEVERAL_AXES:
        assert len(figure.axes) == SEVERAL_AXES[name]
        with pytest.raises(ValueError, match=f"ax must be None for {name}"):
            result.plot(figure.axes[0])


def test_the_values_after_each_sweep_are_the_books():
    found = lines("4.1")
    rows: dict[str, list[float]] = {
        "k = 1": [0, -1, -1, -1],
        "k = 2": [0, -1.75, -2, -2],  # the book cuts -1.75 to -1.7
        "k = 3": [0, -2.4375, -2.9375, -3],
        "k = 10": [0, -6.138, -8.352, -8.967],
        "k = ∞": [0, -14, -20, -22],
    }
    for name, row in rows.items():
        np.testing.assert_allclose(found[name].mean[:4], row, atol=5e-4)


@pytest.mark.slow
def test_the_policies_of_the_rental_have_the_books_shape():
    found = lines("4.2")
    last, values = (found[name].mean.reshape(21, 21) for name in ("π4", "value of π4"))
    assert (found["π0"].mean == 0).all()
    assert last[20, 0] == last[12, 1] == 5
    assert last[0, 20] == -4
    assert last[10, 10] == 0
    assert (np.diff(last, axis=0) >= 0).all() >= (np.diff(last, axis=1) <= 0).all()
    assert values.min() == values[0, 0] == pytest.approx(421.4, abs=0.1)
    assert values.max() == values[20, 20]


def test_the_gamblers_values_and_stakes_are_known():
    found = lines("4.3")
    capital, values, stakes = found["final values"].x, found["final values"].mean, found["final policy (stake)"].mean
    assert dict(zip(capital, values, strict=True))[50.0] == pytest.approx(0.4)
    assert [stakes[np.searchsorted(capital, one)] for one in (25, 50, 75, 51, 12)] == [25, 50, 25, 1, 12]
    for earlier, later in (("sweep 1", "sweep 2"), ("sweep 2", "sweep 3"), ("sweep 32", "final values")):
        assert (found[later].mean >= found[earlier].mean - 1e-12).all()


def test_sample_updates_have_the_error_of_simulated_ones():
    """The error of the mean of t next values, drawn from b with an error of 1 between them and the first estimate."""
    rng, branching, updates = np.random.default_rng(0), 10, 20
    found = lines("8.7")["b = 10"]
    values = rng.standard_normal((4000, branching))
    # The variance of the b values about their mean makes the first error 1 in the book's formula.
    values -= values.mean(axis=1, keepdims=True)
    values *= np.sqrt((branching - 1) / branching) / values.std(axis=1, keepdims=True)
    chosen = rng.integers(branching, size=(4000, updates))
    means = np.take_along_axis(values, chosen, axis=1).cumsum(axis=1) / np.arange(1, updates + 1)
    errors = np.sqrt((means**2).mean(axis=0))
    np.testing.assert_allclose(found.mean[1:], errors, rtol=0.05)


@pytest.fixture(scope="module")
def small():
    experiment = qtab.book.find("8.8")
    assert isinstance(experiment, UpdateDistributions)
    parts = tuple(part / 6 for part in range(7))
    return dataclasses.replace(experiment, tasks=(Tasks(60, 1, 600), Tasks(90, 3, 900)), parts=parts)


@pytest.mark.slow
def test_updates_on_policy_are_better_at_first_and_worse_in_the_end(small):
    result = small.run(40, seed=5)
    on_policy, uniform = (line.mean for line in result.lines[:2])
    assert on_policy[1] > uniform[1]
    assert on_policy[-1] <= uniform[-1]
    assert result.lines[0].x.tolist() == [0, 100, 200, 300, 400, 500, 600]
    text = str(result)
    assert "40 runs of each setting (FEWER than the 200" in text
    assert "truncated" not in text
    assert len(result.plot().figure.axes) == 2


def test_threads_do_not_change_the_values(small):
    one, two = small.run(3, seed=8, threads=1), small.run(3, seed=8, threads=2)
    for ours, theirs in zip(one.lines, two.lines, strict=True):
        assert ours.mean.tobytes() == theirs.mean.tobytes()
