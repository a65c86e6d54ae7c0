"""Names in the figures stay inside their axes and cover no line; lines can be told apart by their colors and widths."""

import dataclasses
import itertools
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.book.drawing import draw_lines, pale
from qtab.book.drawing.colors import line_colors
from qtab.book.drawing.end_labels import BRIGHTEST, label_ends, text_shade
from qtab.book.drawing.minimum_labels import label_minima
from qtab.book.line import Line
from qtab.book.result import Result
from qtab.plots.parts.colors import brightness, sequential

plt: Any = pytest.importorskip("matplotlib.pyplot")


def line(name: str, heights: Any) -> Line:
    none = np.zeros(len(heights), np.int64)
    return Line(name, np.arange(float(len(heights))), np.array(heights, float), np.zeros(len(heights)), 1, none, none)


def test_names_at_the_ends_of_lines_near_the_axis_stay_above_its_ticks() -> None:
    figure, ax = plt.subplots()
    ax.set(xlim=(0, 2), ylim=(0, 100))
    lines = [line(name, [50.0, 10.0, height]) for name, height in (("one", 0.0), ("two", 0.5), ("three", 1.0))]
    assert label_ends(ax, lines, ["black"] * 3)
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in ax.texts]
    assert min(box.y0 for box in boxes) >= ax.get_window_extent().y0 - 1
    assert not boxes[0].overlaps(boxes[1])
    assert not boxes[1].overlaps(boxes[2])
    plt.close(figure)


@pytest.mark.parametrize(
    ("names", "values"),
    [
        (["α = 0.1/8", "α = 0.5/8", "α = 0.2/8"], [0.1, 0.5, 0.2]),
        (["α = 2⁻¹²", "α = 2⁻¹⁴", "α = 2⁻¹³"], [4.0, 1.0, 2.0]),
    ],
)
def test_fractions_and_powers_are_values_of_a_parameter(names: list[str], values: list[float]) -> None:
    figure, ax = plt.subplots()
    assert line_colors([line(name, [0.0]) for name in names], ax) == sequential(values, ax)
    plt.close(figure)


def distances(drawn: Any) -> Any:
    """How far apart the colors of the lines are, in each pair."""
    from matplotlib.colors import to_rgb

    colors = np.array([to_rgb(one.get_color()) for one in drawn])
    return np.linalg.norm(colors[:, None] - colors, axis=-1)[np.triu_indices(len(colors), 1)]


def test_runs_that_differ_by_their_seeds_have_colors_without_an_order_and_no_names() -> None:
    result = qtab.book.run("figure-2.1", progress=False)  # any experiment: only its layout counts
    runs = [dataclasses.replace(line(f"run {k}", [1.0, k, 1.0]), named=False) for k in range(10)]
    ax = draw_lines(dataclasses.replace(result, lines=tuple(runs)), None)
    assert ax.get_legend() is None
    assert not ax.texts
    assert distances(ax.lines).min() > 0.15
    few: Any = qtab.book.EXPERIMENTS["figure-5.4"]
    (setting,) = few.settings
    short = dataclasses.replace(
        setting, arguments={**setting.arguments, "episodes": 9, "record": [1, 4, 9]}, x=(1.0, 4.0, 9.0)
    )
    drawn = dataclasses.replace(few, settings=(short,)).run(3, progress=False)
    assert [one.name for one in drawn.lines] == ["run 1", "run 2", "run 3"]
    assert drawn.plot().get_legend() is None
    plt.close("all")


def test_the_initial_values_of_example_6_2_do_not_hide_behind_those_after_one_episode() -> None:
    ax: Any = qtab.book.run("example-6.2", runs=1, progress=False).plot()
    drawn = {one.get_label(): one for one in ax.figure.axes[0].lines}
    below, above = drawn["after 0 episodes"], drawn["after 1 episode"]
    assert np.isclose(below.get_ydata(), above.get_ydata()).sum() >= 4
    assert below.get_zorder() < above.get_zorder()
    assert below.get_linewidth() > 2 * above.get_linewidth()
    plt.close("all")


@pytest.mark.parametrize("name", ["figure-13.1", "figure-13.2"])
def test_a_figure_with_more_runs_than_the_books_says_so(name: str) -> None:
    experiment = qtab.book.EXPERIMENTS[name]
    assert experiment.runs == 1_000
    assert "1,000 runs here, as a few stuck runs dominate the mean of 100" in experiment.book


def minima(heights: Any) -> list[Line]:
    """Lines with a minimum in the middle, at these heights."""
    return [line(f"n = {2**k}", [0.9, height, 0.9]) for k, height in enumerate(heights)]


def test_lines_with_a_minimum_are_named_below_it() -> None:
    figure, ax = plt.subplots()
    ax.set(xlim=(0, 2), ylim=(0, 1))
    assert label_minima(ax, minima([0.8, 0.6, 0.599, 0.02]), ["black"] * 4)
    assert {text.get_text() for text in ax.texts} == {"n = 1", "n = 2, 4", "n = 8"}
    heights = {text.get_text(): text.get_position()[1] for text in ax.texts}
    assert heights["n = 1"] < 0.8
    assert 0.02 < heights["n = 8"] < heights["n = 2, 4"] < 0.6  # there is no room below the lowest
    boxes = [text.get_window_extent() for text in ax.texts]
    assert not any(one.overlaps(other) for one in boxes for other in boxes if one is not other)
    plt.close(figure)


@pytest.mark.parametrize(
    "lines",
    [
        minima([0.8, 0.5, 0.2]),
        [*minima([0.8, 0.5]), *(line(f"n = {k}", [0.9, 0.5, k]) for k in (0.1, 0.2))],
        minima([-0.5] * 4),
    ],
)
def test_other_lines_have_a_legend(lines: list[Line]) -> None:
    figure, ax = plt.subplots()
    ax.set(xlim=(0, 2), ylim=(0, 1))
    assert not label_minima(ax, lines, ["black"] * len(lines))
    assert not ax.texts
    plt.close(figure)


def test_names_in_light_colors_are_darkened() -> None:
    from matplotlib.colors import to_hex

    figure, ax = plt.subplots()
    assert text_shade("#1f5fa8", ax) == "#1f5fa8"
    assert brightness(text_shade("#addc30", ax)) == pytest.approx(BRIGHTEST, abs=0.01)
    assert pale("#000000", ax) == "#999999"
    ax.set_facecolor("black")
    assert text_shade("#addc30", ax) == to_hex("#addc30")
    plt.close(figure)


def test_rounding_is_no_standard_error_and_diverged_runs_do_not_widen_the_table() -> None:
    result = qtab.book.run("example-6.6", runs=2, progress=False)
    first = result.lines[0]
    mean, error = np.array([0.1, 1e200, 2.0]), np.array([1e-17, 1e200, 0.5])
    x = np.array([1.0, 10.0, 25.0])
    odd = dataclasses.replace(
        first, x=x, mean=mean, error=error, truncated=first.truncated[:3], diverged=first.diverged[:3]
    )
    rows = [row.split()[1:4] for row in str(dataclasses.replace(result, lines=(odd,))).splitlines()[-3:]]
    assert rows == [["1", "0.1", "0"], ["10", "1e+200", "1e+200"], ["25", "2.00", "0.50"]]


@pytest.mark.parametrize("name", ["section-9.5.2", "figure-10.2"])
def test_the_numbers_beside_a_logarithmic_axis_do_not_touch(name: str) -> None:
    experiment = qtab.book.find(name)
    figure, ax = plt.subplots(figsize=(8, 3.6))
    lines = [line(name, [1200.0, 120.0]) for name in experiment.line_names]
    draw_lines(Result(experiment, tuple(lines), 1, 0, 0.0, draw_lines), ax)
    figure.canvas.draw()
    labels = [*ax.get_yticklabels(), *ax.get_yticklabels(minor=True)]
    low, high = ax.get_ylim()
    shown = [label for label in labels if label.get_text() and low <= label.get_position()[1] <= high]
    assert {"100", "200", "300", "400", "500", "600", "800", "1,000"} == {label.get_text() for label in shown}
    boxes = sorted((label.get_window_extent() for label in shown), key=lambda box: box.y0)
    assert all(below.y1 < above.y0 for below, above in itertools.pairwise(boxes))
    plt.close(figure)
