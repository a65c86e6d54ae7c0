"""Names in the figures stay inside their axes and cover no line; parameters have sequential colors."""

from typing import Any

import numpy as np
import pytest

from qtab.book.drawing.colors import line_colors
from qtab.book.drawing.end_labels import label_ends
from qtab.book.drawing.top_labels import label_tops
from qtab.book.result import Line
from qtab.plots.colors import sequential

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


def test_names_near_the_tops_cover_no_line() -> None:
    figure, ax = plt.subplots()
    lines = [line("the upper line", [1.0, 1.2, 1.0]), line("the lower line", [0.5, 1.18, 0.9])]
    ax.set_ylim(0, 1.6)
    for one in lines:
        ax.plot(one.x, one.mean)
    label_tops(ax, lines)
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in ax.texts]
    assert len(boxes) == 2
    assert not boxes[0].overlaps(boxes[1])
    along = np.linspace(0, 2, 500)
    for one in lines:
        points = ax.transData.transform(np.column_stack([along, np.interp(along, one.x, one.mean)]))
        assert not any(box.contains(x, y) for box in boxes for x, y in points)
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
