"""Figure 9.5: its walks and its updates are those of estimate_values to the bit, and the Fourier basis is better.

Section 9.5.2: smooth features learn faster than tile coding on Mountain Car, and polynomials do not learn.
Figure 9.8: broad features generalize.
"""

import dataclasses
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.book.figures.chapter_09.figure_9_5 import BasisComparison, basis_features
from qtab.book.figures.chapter_09.figure_9_8 import POINTS, WIDTHS, interval_features, learned, square_wave
from qtab.book.figures.chapter_09.long_walk import Steps, gradient_monte_carlo, simulate
from qtab.book.problems import thousand_states

RECORD = (0, 1, 7, 60)


@pytest.fixture(scope="module")
def walks() -> list[Steps]:
    return simulate([4, 5], RECORD[-1])


def test_groups_of_states_have_the_values_of_estimate_values_to_the_bit(walks: list[Steps]) -> None:
    rows = qtab.prediction.state_aggregation(1000, 100)
    task = thousand_states()
    estimates = qtab.estimate_values(
        task.env,
        task.policy,
        method="monte_carlo",
        learning_rate=0.01,
        features=rows,
        episodes=RECORD[-1],
        record=RECORD,
        seeds=[4, 5],
    )
    basis = np.eye(10)[rows[:, 0]]
    # Other methods beside it, and walks of other lengths, change nothing.
    _, found = gradient_monte_carlo(walks, [basis_features("polynomials", 3), basis], [1e-4, 0.01], RECORD)
    assert found[:, :, ::100].tobytes() == estimates.weights.tobytes()


def test_the_updates_of_a_basis_are_those_of_gradient_monte_carlo(walks: list[Steps]) -> None:
    features = basis_features("Fourier basis", 5)
    [found] = gradient_monte_carlo(walks, [features], [5e-3], RECORD)
    w = np.zeros(6)
    for state, target in zip(walks[1].states, walks[1].returns, strict=True):
        w += 5e-3 * (target - w @ features[state]) * features[state]
    np.testing.assert_allclose(found[1, -1], features @ w, rtol=1e-10)
    assert len(walks[1].ends) == RECORD[-1]
    assert len(walks[1].states) == walks[1].ends[-1]


def test_bases_are_the_books() -> None:
    place = (np.arange(1000) + 0.5) / 1000
    np.testing.assert_allclose(basis_features("Fourier basis", 2), np.cos(np.pi * np.outer(place, [0, 1, 2])))
    np.testing.assert_allclose(basis_features("polynomials", 2), np.stack([place**0, place, place * place], axis=1))


def test_the_fourier_basis_learns_faster() -> None:
    experiment: Any = qtab.book.find("9.5")
    assert isinstance(experiment, BasisComparison)
    result = dataclasses.replace(experiment, episodes=200).run(3, seed=2)
    assert [line.name for line in result.lines] == list(experiment.line_names)
    polynomials, fourier = result.lines[:3], result.lines[3:]
    exact = thousand_states().true_values
    start = np.sqrt((exact.state_distribution * exact.values**2).sum())
    assert all(line.x[-1] == 200 and line.mean[0] == pytest.approx(start) for line in result.lines)
    for one, other in zip(fourier, polynomials, strict=True):
        assert one.mean[-1] < one.mean[0]
        assert one.mean[-1] < other.mean[-1]
    assert len(result.plot().lines) == 6


def test_smooth_features_learn_faster_than_tile_coding_on_mountain_car_and_polynomials_do_not_learn() -> None:
    result = qtab.book.run("9.5.2", runs=3, seed=300)
    *bases, tiles = result.lines
    assert [line.method for line in bases] == ["Fourier basis", "radial basis functions", "polynomials"] * 3
    for line in bases:
        if line.method == "polynomials":
            assert line.mean.mean() > 3000
            assert line.truncated.sum() > 150
        else:
            assert line.mean[:10].sum() < 0.8 * tiles.mean[:10].sum()
            assert 110 < line.mean[-20:].mean() < 200
            assert line.truncated.sum() == 0
    assert 100 < tiles.mean[-20:].mean() < 135
    figure: Any = result.plot().figure
    # Polynomials are far above the others, so that only the table has them.
    assert [len(part.lines) for part in figure.axes] == [3, 3, 3]
    assert [part.get_title(loc="left").split(",")[0] for part in figure.axes] == ["order 3", "order 5", "order 7"]


def test_the_bases_of_a_panel_have_as_many_features() -> None:
    counts = []
    experiment: Any = qtab.book.find("9.5.2")
    for setting in experiment.settings[:-1]:
        config = {**setting.config, "episodes": 1, "max_episode_steps": 1, "seed": 0}
        counts.append(qtab.train(setting.env, **config).tables.shape[1])
    assert counts == [16] * 3 + [36] * 3 + [64] * 3


def test_as_many_intervals_contain_each_place() -> None:
    for width, count in zip(WIDTHS.values(), (5, 10, 25), strict=True):
        features = interval_features(POINTS, width)
        assert set(features.sum(axis=1)) <= {count, count + 1.0}
        # An example changes the function as far as its features reach, and by a fifth of the error where it is.
        [after] = learned(width, np.array([0.5025]), [1])
        assert after[np.argmin(np.abs(POINTS - 0.5025))] == pytest.approx(0.2)
        assert (after > 0.0).mean() == pytest.approx(2 * width, abs=0.05)


def test_the_width_of_features_matters_at_first_and_hardly_in_the_end() -> None:
    result = qtab.book.run("figure-9.8", seed=1)
    assert (result.runs, len(result.lines)) == (1, 19)
    wave, *found = (line.mean for line in result.lines)
    assert np.array_equal(wave, square_wave(POINTS))
    errors = np.sqrt(np.mean((np.array(found) - wave) ** 2, axis=1)).reshape(3, 6)
    assert (np.diff(errors, axis=1) < 0.0).all()
    assert errors[0, 0] > errors[1, 0] > errors[2, 0] > 0.3
    assert errors[:, -1].max() < 0.06
    assert f"{errors[2, 1]:.3f}" in str(result)
    assert len(result.plot().figure.axes) == 18
