"""Details of pictures: rates that fall, lines that coincide, panels below each other, the color of 0."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import qtab

plt = pytest.importorskip("matplotlib.pyplot")
from matplotlib.colors import to_rgba  # noqa: E402 - after the check for matplotlib

from qtab.plots.difference import name_zero  # noqa: E402
from qtab.plots.parts.marks import mark_optimum, mark_threshold  # noqa: E402

LAKE = "FrozenLake-v1"


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    plt.close("all")


@pytest.mark.parametrize(
    ("settings", "note"),
    [
        ({"learning_rate": 0.5, "learning_rate_schedule": "linear", "min_learning_rate": 0.0}, "α = 0.5 → 0, "),
        (
            {"learning_rate": 0.5, "learning_rate_schedule": "exponential", "min_learning_rate": 0.49},
            "α = 0.5 → 0.49, ",
        ),
        ({"learning_rate": 1.0, "learning_rate_schedule": "visits"}, "α = 1 / visits, "),
        (
            {"learning_rate": 0.05, "learning_rate_schedule": "visits", "min_learning_rate": 0.01},
            "α = 0.05 / visits, ≥ 0.01, ",
        ),
        ({"learning_rate": 0.5, "learning_rate_schedule": "constant"}, "α = 0.5, "),
        ({"epsilon": 0.0, "epsilon_schedule": "linear", "min_epsilon": 0.0}, ", ε = 0, "),
        ({"epsilon": 0.5, "epsilon_schedule": "linear", "min_epsilon": 0.1}, ", ε = 0.5 → 0.1, "),
        ({"epsilon": 1.0, "epsilon_schedule": "exponential", "epsilon_decay": 0.999}, ", ε = 1 → 0.962, "),
    ],
)
def test_the_note_has_the_rates_of_the_schedule(settings: dict[str, Any], note: str) -> None:
    run = qtab.train(LAKE, seed=0, episodes=40, **settings)
    assert note in qtab.plot(run).get_title("right")


def test_the_note_of_a_stopped_run_has_the_rate_of_its_last_episode() -> None:
    falling: dict[str, Any] = {"epsilon": 1.0, "epsilon_schedule": "linear", "min_epsilon": 0.0}
    stop: dict[str, Any] = {"callback": lambda progress: progress.episodes < 11, "callback_every": 11}
    run = qtab.train(LAKE, seed=0, episodes=40, **falling, **stop)
    assert ", ε = 1 → 0.75, " in qtab.plot(run).get_title("right")


def lines(ax: Any) -> list[str]:
    return [line.get_label() for line in ax.get_lines() if len(set(line.get_ydata())) == 1 and line.get_zorder() == 4]


def test_an_optimum_and_a_threshold_that_coincide_are_one_line_with_two_names() -> None:
    run = qtab.train("CartPole-v1", seed=0, episodes=60)
    plot = qtab.plot
    assert lines(plot(run, optimum=475.0, threshold=475.0)) == ["optimum and threshold 475"]
    assert lines(plot(run, optimum=474.9, threshold=475.0)) == ["optimum 474.9, threshold 475"]
    assert lines(plot(run, optimum=500.0, threshold=475.0)) == ["optimum 500", "threshold 475"]


def test_a_second_curve_on_the_same_axes_adds_no_second_line() -> None:
    run = qtab.train("CartPole-v1", seed=0, episodes=60)
    ax = qtab.plot(run, optimum=475.0, threshold=475.0)
    qtab.plot(run, ax, optimum=475.0, threshold=475.0)
    assert lines(ax) == ["optimum and threshold 475"]


def test_the_order_of_an_optimum_and_a_threshold_does_not_matter() -> None:
    run = qtab.train(LAKE, seed=0, episodes=60)
    ax = qtab.plot(run, threshold=0.7)
    qtab.plot(run, ax, optimum=0.7)
    assert lines(ax) == ["optimum and threshold 0.7"]
    qtab.plot(run, ax, threshold=0.7)
    assert lines(ax) == ["optimum and threshold 0.7"]


def test_a_threshold_whose_digits_begin_another_one_has_a_name_of_its_own() -> None:
    ax = plt.figure().subplots()
    ax.plot([-2000.0, 2000.0])
    mark_optimum(ax, 10.0)
    for threshold in (10.0, 1.0, 1.0):
        mark_threshold(ax, threshold)
    assert lines(ax) == ["optimum and threshold 10, threshold 1"]


@pytest.mark.parametrize(
    ("highest", "texts"),
    [
        (1e-6, ["0", "2e-07", "4e-07", "6e-07", "8e-07", "1e-06"]),
        (1.25, ["0", "0.25", "0.50", "0.75", "1.00", "1.25"]),
        (2.5e6, ["0", "500,000", "1,000,000", "1,500,000", "2,000,000", "2,500,000"]),
        (1e9, ["0", "2e+08", "4e+08", "6e+08", "8e+08", "1e+09"]),
    ],
)
def test_small_and_large_costs_are_written_beside_the_color_bar(highest: float, texts: list[str]) -> None:
    figure = plt.figure()
    ax = figure.subplots()
    image = ax.imshow([[0.0, highest]], vmin=-highest / 16, vmax=highest)
    bar = figure.colorbar(image)
    name_zero(bar, -highest / 16, highest)
    figure.canvas.draw()
    assert [text.get_text() for text in bar.ax.get_yticklabels()] == texts


def test_wide_maps_lie_below_each_other_and_others_side_by_side() -> None:
    settings: dict[str, Any] = {"seed": 0, "episodes": 20, "max_episode_steps": 100}
    for env, columns in (("CliffWalking-v1", 1), (LAKE, 3)):
        runs = [qtab.train(env, algorithm=name, **settings) for name in ("q_learning", "sarsa", "expected_sarsa")]
        figure: Any = qtab.plots.policy(runs).figure
        grid = figure.axes[0].get_subplotspec().get_gridspec()
        assert (grid.nrows, grid.ncols) == (3 // columns, columns)


@pytest.mark.parametrize("style", ["default", "dark_background"])
def test_the_color_bar_of_costs_starts_with_the_background_for_0(style: str) -> None:
    with plt.style.context(style):
        run = qtab.train(LAKE, seed=0, episodes=1000)
        ax = qtab.plots.difference(run, qtab.optimum(LAKE))
        ax.figure.canvas.draw()
        image: Any = next(one for one in ax.collections if one.get_array() is not None and one.colorbar is not None)
        bar = image.colorbar
        first = bar.ax.get_yticklabels()[0]
        assert first.get_text() == "0"
        assert image.to_rgba(first.get_position()[1]) == pytest.approx(np.array(to_rgba(ax.get_facecolor())))
        smallest = min(cost for cost in np.ma.compressed(image.get_array()) if cost > 0)
        assert image.to_rgba(smallest) != pytest.approx(np.array(to_rgba(ax.get_facecolor())))
