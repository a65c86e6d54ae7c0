"""Names at the highest points of lines, which read more easily than a legend where lines end at different x."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from qtab.book.drawing.colors import line_colors
from qtab.book.result import Line

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def label_tops(ax: "Axes", lines: Sequence[Line]) -> None:
    """Writes the name of each line above its highest point, in the color of the line, instead of a legend."""
    for line, hue in zip(lines, line_colors(lines, ax), strict=True):
        top = int(np.argmax(line.mean))
        point = (float(line.x[top]), float(line.mean[top] + 2 * np.nan_to_num(line.error[top])))
        ax.annotate(line.name, point, (0, 5), textcoords="offset points", color=hue, fontsize=9, ha="center")
    legend = ax.get_legend()
    if legend is not None:
        legend.remove()
