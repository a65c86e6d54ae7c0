"""The figures of chapter 11: their claims, their tables and their pictures."""

import functools

import numpy as np
import pytest

import qtab
from qtab.book.figures.chapter_11 import figure_11_3
from qtab.book.figures.chapter_11.baird import UPPER, CounterexampleExperiment
from qtab.book.result import Result

NAMES = [name for name, one in qtab.book.EXPERIMENTS.items() if isinstance(one, CounterexampleExperiment)]
computed = functools.cache(qtab.book.run)


def lines(result: Result, title: str) -> dict[str, np.ndarray]:
    """The points of the lines of a method by their names."""
    prefix = f"{title}: "
    return {line.name.removeprefix(prefix): line.mean for line in result.lines if line.name.startswith(prefix)}


@pytest.mark.parametrize("name", NAMES)
def test_a_figure_has_a_table_and_a_panel_for_each_method(name: str) -> None:
    result = computed(name)
    experiment = result.experiment
    assert isinstance(experiment, CounterexampleExperiment)
    assert [line.name for line in result.lines] == list(experiment.line_names)
    assert all(line.name in str(result) for line in result.lines)
    axes = result.plot().figure.axes
    assert [ax.get_xlabel() for ax in axes] == [part.x_label for part in experiment.parts]
    assert sum(len(ax.lines) for ax in axes) == len(result.lines)
    for ax in axes:
        assert {text.get_text() for text in ax.texts} == {UPPER, "w7", "w8", *experiment.errors}


def test_semi_gradient_methods_diverge() -> None:
    for title in ("semi-gradient off-policy TD", "semi-gradient DP"):
        found = lines(computed("figure-11.2"), title)
        assert found["w8"][-1] > 200 > 5 * found["w8"][200]
    # The first sweep by hand: δ = 0.99 * 12 - 3 in six states and 0.99 * 12 - 12 in the lower one.
    dp = lines(computed("figure-11.2"), "semi-gradient DP")
    upper, lower = 0.99 * 12 - 3, 0.99 * 12 - 12
    assert dp[UPPER][1] == pytest.approx(1 + 0.01 / 7 * 2 * upper, rel=1e-13)
    assert dp["w7"][1] == pytest.approx(10 + 0.01 / 7 * lower, rel=1e-13)
    assert dp["w8"][1] == pytest.approx(1 + 0.01 / 7 * (6 * upper + 2 * lower), rel=1e-13)


def test_tdc_reduces_the_projected_error_but_not_the_value_error() -> None:
    for title in ("TDC", "expected TDC"):
        found = lines(computed("figure-11.5"), title)
        assert found["√PBE"][-1] < 0.1 < 8 < found["√PBE"][0]
        assert found["√VE"][-1] == pytest.approx(2.0, abs=0.1)  # "which remains almost 2"


def test_emphatic_td_finds_values_of_zero() -> None:
    found = lines(computed("figure-11.6"), "expected emphatic TD")
    assert found["√VE"][-1] < 1e-9
    # The book: proportional to (1, 1, 1, 1, 1, 1, 4, -2).
    np.testing.assert_allclose([found["w7"][-1], found["w8"][-1]], [4 * found[UPPER][-1], -2 * found[UPPER][-1]])


def test_several_runs_are_averaged_with_their_standard_errors() -> None:
    result = qtab.book.run("11.5", 3, 7)
    alone = [lines(qtab.book.run("11.5", 1, seed), "TDC")["w8"] for seed in (7, 8, 9)]
    [line] = [line for line in result.lines if line.name == "TDC: w8"]
    np.testing.assert_allclose(line.mean, np.mean(alone, axis=0))
    np.testing.assert_allclose(line.error, np.std(alone, axis=0, ddof=1) / np.sqrt(3), atol=1e-15)
    assert line.error[-1] > 0
    [exact] = [line for line in result.lines if line.name == "expected TDC: w8"]
    assert exact.runs == 1


def test_the_smallest_errors_of_the_split_examples_are_at_the_books_values() -> None:
    split = {line.name: line.mean.tolist() for line in computed("example-11.2").lines}
    presplit = {line.name: line.mean.tolist() for line in computed("example-11.3").lines}
    assert split["true values"] == split["TD fixed point"] == split["smallest Bellman error"] == [0.5, 1.0, 0.0]
    assert split["smallest TD error"] == [0.5, 0.75, 0.25]
    assert presplit["true values"] == [1.0, 0.0, 1.0, 0.0]
    assert presplit["TD fixed point"] == [0.5, 0.5, 1.0, 0.0]
    assert presplit["smallest Bellman error"] == presplit["smallest TD error"] == [0.5, 0.5, 0.75, 0.25]


def test_distances_in_the_plane_are_errors() -> None:
    places = {line.name: np.array([line.x[0], line.mean[0]]) for line in computed("figure-11.3").lines}
    geometry, weights = figure_11_3.geometry(), figure_11_3.weights()
    arrow = np.linalg.norm(places[figure_11_3.BACKED_UP] - places[figure_11_3.ANY])
    assert arrow == pytest.approx(np.sqrt(geometry.projected_bellman_error(weights[figure_11_3.ANY])))
    best, *others = figure_11_3.POINTS
    for name in others:
        # Pythagoras: the value error is the distance from the plane and the distance within it.
        square = geometry.value_error(weights[best]) + ((places[name] - places[best]) ** 2).sum()
        assert square == pytest.approx(geometry.value_error(weights[name]))
    apart = [np.linalg.norm(places[one] - places[other]) for one, other in (others, (best, others[0]))]
    assert min(apart) > 0.5
    ax = computed("figure-11.3").plot()
    assert {text.get_text() for text in ax.texts} >= set(places)


@pytest.mark.parametrize(("name", "states"), [("example-11.2", "A B C"), ("example-11.3", "A1 A2 B C")])
def test_the_tables_of_the_examples_name_the_states(name: str, states: str) -> None:
    rows = [row for row in str(computed(name)).splitlines() if row.startswith("true values")]
    assert [row.split()[2] for row in rows] == states.split()
