"""LSTD and TD on Boyan's chain: which one is better when, and the same episodes for both."""

import dataclasses
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.book.figures.chapter_09.section_9_8 import BoyanChain


@pytest.fixture(scope="module")
def result() -> Any:
    experiment = qtab.book.find("section-9.8")
    assert isinstance(experiment, BoyanChain)
    return dataclasses.replace(experiment, episodes=20).run(4, seed=3)


def test_lstd_needs_far_fewer_episodes(result: Any) -> None:
    least_squares, *others = (line.mean for line in result.lines)
    assert least_squares[0] == pytest.approx(np.sqrt(np.mean((2.0 * np.arange(13)) ** 2)))
    assert (least_squares[[1, 5, 20]] < 0.5 * np.min([line[[1, 5, 20]] for line in others], axis=0)).sum() >= 2
    assert least_squares[20] < 1.0 < 4.0 < others[1][20]
    # Among constant step sizes, the largest is fastest.
    assert others[2][5] < others[1][5] < others[0][5]


def test_it_has_a_table_and_a_picture(result: Any) -> None:
    assert [line.name for line in result.lines] == list(result.experiment.line_names)
    assert result.lines[0].runs == 4
    assert "FEWER than the 30" in str(result)
    ax = result.plot()
    assert len(ax.lines) == len(result.lines)


def test_a_run_does_not_depend_on_the_others(result: Any) -> None:
    alone = np.array([result.experiment.run(1, seed=seed).lines[0].mean for seed in range(3, 7)])
    np.testing.assert_allclose(alone.mean(axis=0), result.lines[0].mean, rtol=1e-13)
