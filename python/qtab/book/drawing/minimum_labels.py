"""Names below the minima of lines, which read more easily than a legend with many shades of a color."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.drawing.end_labels import LINE_HEIGHT, text_shade
from qtab.book.line import Line
from qtab.plots.parts.labels import CHARACTER

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEAST_LINES = 4
"""With fewer lines, a legend is as easy to read."""
GAP = 0.9
"""The distance of a label from its minimum, in font sizes. It is below the minimum, or above if there is no room."""
TOGETHER = 1.0
"""Lines whose minima are not further apart than this, in font sizes, share a label."""
MAX_SHIFT = 4.0
"""How far a label may be moved down from its line, in font sizes; if one has to move further, all get a legend."""


def label_minima(ax: "Axes", lines: Sequence[Line], colors: Sequence[Any]) -> bool:
    """Writes the name of each line below its minimum, in the color of the line.

    Returns False and writes nothing if several lines have their minimum at an end, if one has it outside the axes, or
    if the labels do not fit, so that a legend is needed.
    """
    from matplotlib import rcParams

    points = [point for line in lines if (point := _minimum(ax, line)) is not None]
    at_ends = sum(x in (line.x[0], line.x[-1]) for line, (x, _) in zip(lines, points, strict=False))
    if len(lines) < LEAST_LINES or len(points) < len(lines) or at_ends > 1:
        return False
    pixels = rcParams["font.size"] * ax.figure.dpi / 72
    bottom = ax.get_window_extent().y0 + LINE_HEIGHT * pixels / 2
    labels: list[tuple[Any, list[str], Any]] = []  # the place in pixels, the names, and the color
    for line, point, hue in zip(lines, points, colors, strict=True):
        place = ax.transData.transform(point)
        for other, names, _ in labels:
            if np.abs(other - place).max() < TOGETHER * pixels:
                names.append(line.name)
                break
        else:
            labels.append((place, [line.name], hue))
    placed: list[tuple[float, float, str, Any]] = []
    for place, names, hue in sorted(labels, key=lambda label: -label[0][1]):
        below = place[1] - GAP * pixels
        text, x, y = _joined(names), place[0], below if below >= bottom else place[1] + GAP * pixels
        while any(_overlap(x, y, text, one, pixels) for one in placed):
            y -= 0.25 * pixels
        if place[1] - y > MAX_SHIFT * pixels or y < bottom:
            return False
        placed.append((x, y, text, hue))
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=3, foreground=ax.get_facecolor())]
    for x, y, text, hue in placed:
        at = ax.transData.inverted().transform((x, y)).tolist()
        style: dict[str, Any] = {"color": text_shade(hue, ax), "fontsize": rcParams["font.size"], "path_effects": halo}
        ax.text(at[0], at[1], text, ha="center", va="center", **style)
    return True


def _minimum(ax: "Axes", line: Line) -> "tuple[float, float] | None":
    """Returns the lowest point of a line, if it is inside the axes."""
    if not np.isfinite(line.mean).any():
        return None
    lowest = int(np.nanargmin(line.mean))
    x, y = float(line.x[lowest]), float(line.mean[lowest])
    (left, right), (low, high) = sorted(ax.get_xlim()), sorted(ax.get_ylim())
    inside = left <= x <= right and low <= y <= high
    return (x, y) if inside else None


def _joined(names: Sequence[str]) -> str:
    """Returns ``"n = 8"`` and ``"n = 16"`` as ``"n = 8, 16"``."""
    parameter, equals, _ = names[0].partition(" = ")
    prefix = parameter + equals
    if not equals or not all(name.startswith(prefix) for name in names):
        prefix = ""
    return prefix + ", ".join(name.removeprefix(prefix) for name in names)


def _overlap(x: float, y: float, text: str, other: tuple[float, float, str, Any], pixels: float) -> bool:
    width = (len(text) + len(other[2]) + 2) * CHARACTER * pixels / 2
    return abs(x - other[0]) < width and abs(y - other[1]) < LINE_HEIGHT * pixels
