"""Names in the figures stay inside their axes and cover no line; lines can be told apart by their colors and widths."""

import dataclasses
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.book.drawing import draw_lines
from qtab.book.drawing.colors import line_colors
from qtab.book.drawing.end_labels import label_ends
from qtab.book.line import Line
from qtab.plots.parts.colors import sequential

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
