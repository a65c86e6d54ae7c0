"""Figures that are made without axes appear with ``plt.show()``.

That a notebook shows them is tested in tests/callbacks/test_notebook.py.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

import qtab
from qtab import plots
from qtab.cli import main
from qtab.plots.parts.axes import not_shown

RETURNS = np.random.default_rng(0).normal(size=(4, 20))


@pytest.mark.parametrize(
    "draw",
    [
        lambda: qtab.plot(qtab.train("MountainCar-v0", seed=0, episodes=5)),
        lambda: plots.learning_curves(RETURNS),
        lambda: plots.distribution(RETURNS[:, 0]),
        lambda: plots.profile({"a": RETURNS}),
    ],
)
def test_pyplot_holds_the_figure_that_a_plot_makes(draw: Any) -> None:
    ax = draw()
    assert plt.get_fignums() == [ax.figure.number]
    assert plt.gca() is ax
    assert draw(**{}) is not ax
    assert len(plt.get_fignums()) == 2


def test_pyplot_does_not_learn_of_axes_that_are_given_or_of_figures_that_are_not_shown() -> None:
    plots.distribution(RETURNS[:, 0], Figure().subplots())
    with not_shown():
        plots.distribution(RETURNS[:, 0])
    assert plt.get_fignums() == []


@pytest.mark.slow
def test_pyplot_does_not_learn_of_figures_for_files(tmp_path: Path) -> None:
    assert main(["train", "MountainCar-v0", "--episodes", "5", "--plot", str(tmp_path / "a.png")]) == 0
    assert main(["book", "example-6.5", "--runs", "2", "--plot", str(tmp_path / "b.png")]) == 0
    store = tmp_path / "a.db"
    qtab.sweep("MountainCar-v0", {"discount": [0.5, 0.9]}, seeds=1, episodes=100, max_episode_steps=5, store=store)
    assert main(["report", str(store), "--out", str(tmp_path / "report")]) == 0
    assert plt.get_fignums() == []
    assert len(list(tmp_path.rglob("*.png"))) >= 6


def test_an_error_leaves_no_empty_figure() -> None:
    for call in (
        lambda: plots.learning_curves([[1.0, np.nan]]),
        lambda: plots.distribution([1.0], bins=10**8),
        lambda: plots.profile({"a": []}),
        lambda: plots.learning_curves(RETURNS, optimum=np.nan),
    ):
        with pytest.raises(ValueError, match="must"):
            call()
    assert plt.get_fignums() == []
