"""Names near the highest points of lines, which read more easily than a legend where lines end at different x."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.drawing.colors import line_colors
from qtab.book.line import Line
from qtab.book.runner import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = 9.0
"""The font size, in points."""
GAP = 5.0
"""The distance of a name from its point, in points."""
PLACES = {"above": ("center", "bottom", 0, 1), "left": ("right", "center", -1, 0), "below": ("center", "top", 0, -1)}
"""Where a name can be, seen from its point: its alignments, and the direction."""
SHIFTS = (0, 6, 12, 18, 24, 30)
"""How much further away a name can be, in points, where it would cover something."""
SAMPLES = 400


def label_tops(ax: "Axes", lines: Sequence[Line]) -> None:
    """Writes the name of each line near its highest point, in the color of the line, instead of a legend.

    A name goes where it covers neither a line nor another name, as near to the top of its line as possible; if there is
    no such place, above the top.
    """
    legend = ax.get_legend()
    if legend is not None:
        legend.remove()
    ax.figure.canvas.draw()  # the layout decides where the points are
    bands = [_band(ax, line) for line in lines]
    colors, written = line_colors(lines, ax), list[Any]()
    for index in sorted(range(len(lines)), key=lambda index: -len(lines[index].name)):
        text: Any = None
        for point, (across, along, x, y), shift in _candidates(ax, lines[index]):
            offset = (x * (GAP + shift), y * (GAP + shift))
            text = ax.annotate(
                lines[index].name,
                point,
                offset,
                textcoords="offset points",
                color=colors[index],
                fontsize=SIZE,
                ha=across,
                va=along,
            )
            box = text.get_window_extent()
            inside = ax.get_window_extent()
            fits = box.x0 >= inside.x0 and box.x1 <= inside.x1 and box.y0 >= inside.y0 and box.y1 <= inside.y1
            if fits and not any(map(box.overlaps, written)) and not any(_covers(box, band) for band in bands):
                written.append(box)
                break
            text.remove()
            text = None
        if text is None:
            top = int(np.argmax(lines[index].mean))
            ax.annotate(
                lines[index].name,
                (float(lines[index].x[top]), _edges(lines[index])[1][top]),
                (0, GAP),
                textcoords="offset points",
                color=colors[index],
                fontsize=SIZE,
                ha="center",
            )


def _edges(line: Line) -> tuple[FloatArray, FloatArray]:
    error = 2 * np.nan_to_num(line.error)
    return line.mean - error, line.mean + error


def _band(ax: "Axes", line: Line) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Returns the x coordinates of points along a line, and the edges of its band there, in pixels."""
    ends = []
    for edge in _edges(line):
        pixels = ax.transData.transform(np.column_stack([line.x, edge]))
        along = np.linspace(pixels[0, 0], pixels[-1, 0], SAMPLES)
        ends.append(np.interp(along, pixels[:, 0], pixels[:, 1]))
    return along, ends[0], ends[1]


def _covers(box: Any, band: tuple[FloatArray, FloatArray, FloatArray]) -> bool:
    along, low, high = band
    return bool(((along >= box.x0) & (along <= box.x1) & (low <= box.y1) & (high >= box.y0)).any())


def _candidates(ax: "Axes", line: Line) -> Iterator[tuple[tuple[float, float], tuple[str, str, int, int], float]]:
    """Yields points, places and shifts, those that are nearest to the top first."""
    low, high = _edges(line)
    pixels = ax.transData.transform(np.column_stack([line.x, line.mean]))
    top = int(np.argmax(line.mean))
    found = []
    for index, place in np.ndindex(len(line.x), len(PLACES)):
        name = list(PLACES)[place]
        if name == "left" and index > 0:
            continue
        height = {"above": high, "left": line.mean, "below": low}[name][index]
        away = float(np.hypot(*(pixels[index] - pixels[top])))
        for shift in SHIFTS:
            # A name beside its line is read more easily than one near the top with something between.
            found.append((away + 12.0 * shift, place, (float(line.x[index]), float(height)), PLACES[name], shift))
    for _, _, point, place_of_text, shift in sorted(found, key=lambda one: one[:3]):
        yield point, place_of_text, shift
