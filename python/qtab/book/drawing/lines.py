"""Lines of the book's figures."""

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.drawing.colors import line_colors
from qtab.book.drawing.end_labels import label_ends
from qtab.book.drawing.minimum_labels import label_minima
from qtab.book.line import Line
from qtab.book.result import Result
from qtab.plots.parts.axes import axes_or_new
from qtab.plots.parts.colors import is_dark
from qtab.plots.parts.labels import finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_MARKERS = 40
"""With a line of more points, a figure has no markers."""
BROAD: Mapping[str, Any] = {"linewidth": 6, "zorder": 1}
"""The style of a line that would hide others, or be hidden by them; its color is :func:`pale`."""
FAR_ABOVE = 1e3
"""The mean from which :func:`draw_in_range` does not draw a point, unless the y axis is longer."""
MOST_LABELED = 100
"""A logarithmic axis over less than this ratio is also labeled between the powers of ten."""


def draw_lines(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the lines of a result with bands of two standard errors on each side, and returns the axes."""
    experiment = result.experiment
    ax = axes_or_new(ax)
    drawn = [line for line in result.lines if line.drawn]
    colors = line_colors(drawn, ax)
    has_markers = max((len(line.x) for line in drawn), default=0) <= MAX_MARKERS
    marker: dict[str, Any] = {"marker": "o", "markersize": 4} if has_markers else {}
    for line, hue in zip(drawn, colors, strict=True):
        draw_band(ax, line, hue)
        style = BROAD if line.broad else {"linewidth": 1.6, **marker}
        label = line.name if line.named else "_nolegend_"
        shade = pale(hue, ax) if line.broad else hue
        ax.plot(line.x, line.mean, "--" if line.dashed else "-", color=shade, label=label, **style)
    if experiment.log_x:
        ax.set_xscale("log")
    if experiment.x_ticks is not None:
        words = [experiment.x_words.get(tick, f"{tick:g}") for tick in experiment.x_ticks]
        ax.set_xticks(experiment.x_ticks, experiment.x_tick_labels or words)
        ax.set_xticks([], minor=True)
    if experiment.y_range is not None:
        ax.set_ylim(*experiment.y_range)
    if experiment.log_y:
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter("{x:,.0f}")
        lowest, highest = ax.get_ylim()
        if highest < MOST_LABELED * lowest:
            # Those of 7 and 9 would touch their neighbors.
            ax.yaxis.set_minor_formatter(lambda y, _: "" if f"{y:.0e}"[0] in "79" else f"{y:,.0f}")
    if experiment.x_range is not None:
        ax.set_xlim(*experiment.x_range)
    for text, height in experiment.y_marks.items():
        across = ax.get_yaxis_transform()
        ax.hlines(height, 0, 1, transform=across, color="0.45", linewidth=1, linestyle=":")
        ax.annotate(
            text, (0.01, height), (0, -11), ("axes fraction", "data"), "offset points", color="0.45", fontsize=9
        )
    finish(ax, experiment.x_label, experiment.y_label, experiment.heading)
    legend = ax.get_legend()
    named = [(line, hue) for line, hue in zip(drawn, colors, strict=True) if line.named]
    lines, hues = [line for line, _ in named], [hue for _, hue in named]
    if legend is not None and (label_ends(ax, lines, hues) or label_minima(ax, lines, hues)):
        legend.remove()
    return ax


def pale(hue: Any, ax: "Axes") -> Any:
    """Returns a color that is mixed with the background, and not transparent, so that a legend shows it as it is."""
    from matplotlib.colors import to_hex, to_rgb, to_rgba

    *back, opacity = to_rgba(ax.get_facecolor())
    if opacity < 1:
        back = [0.0, 0.0, 0.0] if is_dark(ax) else [1.0, 1.0, 1.0]
    red, green, blue = (0.4 * front + 0.6 * behind for front, behind in zip(to_rgb(hue), back, strict=True))
    return to_hex((red, green, blue))


def draw_band(ax: "Axes", line: Line, hue: Any, alpha: float = 0.25) -> None:
    """Draws a band of two standard errors on each side of a line."""
    error = 2 * np.nan_to_num(line.error)
    ax.fill_between(line.x, line.mean - error, line.mean + error, color=hue, alpha=alpha, linewidth=0)


def draw_in_range(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the lines without bands around points far above the figure, where runs diverge; returns the axes."""
    top = 1.1 * (result.experiment.y_range or (0.0, np.inf))[1]
    highest = max(FAR_ABOVE, top) if np.isfinite(top) else FAR_ABOVE
    lines = [dataclasses.replace(one, error=np.where(one.mean < top, one.error, np.nan)) for one in result.lines]
    lines = [dataclasses.replace(one, mean=np.where(one.mean < highest, one.mean, np.nan)) for one in lines]
    return draw_lines(dataclasses.replace(result, lines=tuple(lines)), ax)
