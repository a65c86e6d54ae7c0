"""Names at the right ends of lines, which read more easily than a legend."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.line import Line
from qtab.plots.parts.colors import brightness, is_dark

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_LABELS = 8
"""The largest number of labels; more lines get a legend."""
RELATIVE_SIZE = 0.9
"""The font size, in sizes of Matplotlib's default font."""
LINE_HEIGHT = 1.25
"""The smallest distance between two labels, in font sizes."""
BRIGHTEST = 0.45
"""The largest brightness of text on a light background, from 0 to 1."""
MAX_SHIFT = 3.0
"""The largest distance of a label from its line, in font sizes; if one has to move further, all lines get a legend."""


def label_ends(ax: "Axes", lines: Sequence[Line], colors: Sequence[Any]) -> bool:
    """Writes the name of each line beside its last point inside the axes, in the color of the line.

    Returns False and writes nothing if the labels do not fit, so that a legend is needed.
    """
    from matplotlib import rcParams

    ends = [end for line in lines if (end := _last_point(ax, line)) is not None]
    if not 0 < len(ends) == len(lines) <= MAX_LABELS:
        return False
    if len({x for x, _ in ends}) > 1:
        return False  # a line leaves the axes before the right edge
    size = RELATIVE_SIZE * rcParams["font.size"]
    pixels = size * ax.figure.dpi / 72
    wanted = np.array([ax.transData.transform(end)[1] for end in ends])
    box = ax.get_window_extent()
    shifted = _spread(wanted, LINE_HEIGHT * pixels, (box.y0, box.y1))
    if np.abs(shifted - wanted).max() > MAX_SHIFT * pixels:
        return False
    for line, hue, end, shift in zip(lines, colors, ends, (shifted - wanted) * 72 / ax.figure.dpi, strict=True):
        ax.annotate(
            line.name,
            end,
            (6, shift),
            textcoords="offset points",
            color=text_shade(hue, ax),
            fontsize=size,
            va="center",
            annotation_clip=False,
        )
    return True


def text_shade(hue: Any, ax: "Axes") -> Any:
    """Returns the color of a line for text, darkened if it is hard to read on the background of the axes."""
    from matplotlib.colors import to_hex, to_rgb

    if is_dark(ax):
        return hue
    red, green, blue = (part * min(1.0, BRIGHTEST / max(brightness(hue), 1e-6)) for part in to_rgb(hue))
    return to_hex((red, green, blue))


def _last_point(ax: "Axes", line: Line) -> "tuple[float, float] | None":
    (left, right), (low, high) = sorted(ax.get_xlim()), sorted(ax.get_ylim())
    inside = (line.x >= left) & (line.x <= right) & (line.mean >= low) & (line.mean <= high)
    if not inside.any():
        return None
    last = int(np.flatnonzero(inside)[-1])
    return float(line.x[last]), float(line.mean[last])


def _spread(wanted: Any, distance: float, limits: tuple[float, float]) -> Any:
    """Returns heights in the same order, at least a distance apart and at least half of it inside the limits.

    The middle of each cluster stays in place unless it is outside the limits: the tick labels are below the axes.
    """

    def inside(middle: float, count: int) -> float:
        low, high = limits[0] + distance * count / 2, limits[1] - distance * count / 2
        return max(low, min(middle, high))

    order = np.argsort(wanted, kind="stable")
    clusters: list[tuple[float, int]] = []  # the middle and the number of labels of each, from below
    for height in wanted[order]:
        clusters.append((inside(float(height), 1), 1))
        while len(clusters) > 1:
            (below, n_below), (above, n_above) = clusters[-2:]
            if above - below >= distance * (n_below + n_above) / 2:
                break
            count = n_below + n_above
            clusters[-2:] = [(inside((below * n_below + above * n_above) / count, count), count)]
    heights = [middle + distance * (index - (count - 1) / 2) for middle, count in clusters for index in range(count)]
    spread = np.empty(len(wanted))
    spread[order] = heights
    return spread
