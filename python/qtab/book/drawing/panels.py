"""Figures of several panels, one below the other, with the same x axis."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from qtab.book.drawing.lines import draw_lines
from qtab.book.result import Line, Result
from qtab.plots.axes import shown_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Panel:
    """A part of a figure."""

    y_label: str
    lines: Sequence[Line]
    y_range: tuple[float, float] | None = None
    """The limits of the y axis; None fits the data."""


def draw_panels(result: Result, ax: "Axes | None", panels: Sequence[Panel]) -> "Axes":
    """Draws panels in a new figure, and returns the last axes.

    Raises:
        ValueError: if ``ax`` is not None.
    """
    if ax is not None:
        raise ValueError(f"ax must be None for {result.experiment.name}, which creates {len(panels)} axes")
    figure = shown_figure(8, 3.6 * len(panels))
    axes: Any = figure.subplots(len(panels), 1, sharex=True)
    for panel, below in zip(panels, axes, strict=True):
        experiment: Any = dataclasses.replace(result.experiment, y_label=panel.y_label, y_range=panel.y_range)
        draw_lines(dataclasses.replace(result, experiment=experiment, lines=tuple(panel.lines)), below)
        if below is not axes[0]:
            below.set_title("", loc="left")
        if below is not axes[-1]:
            below.set_xlabel("")
    last: Axes = axes[-1]
    return last
