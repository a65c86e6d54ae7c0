"""Figures of several panels with lines."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from qtab.book.drawing.figures import figure_of_several
from qtab.book.drawing.lines import draw_in_range
from qtab.book.line import Line
from qtab.book.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Panel:
    """A part of a figure."""

    title: str
    lines: Sequence[Line]
    layout: Mapping[str, Any] = field(default_factory=dict)
    """The fields of :class:`Description` that differ from those of the experiment."""


def draw_panels(result: Result, ax: "Axes | None", panels: Sequence[Panel], *, shared_x: bool) -> "Axes":
    """Draws panels in a new figure, one below the other if they share the x axis, else side by side.

    Returns the last axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if ``ax`` is not None.
    """
    count = len(panels)
    figure = figure_of_several(result, ax, *((8, 3.6 * count) if shared_x else (6.5 * count, 4.8)))
    axes: Any = figure.subplots(*((count, 1) if shared_x else (1, count)), sharex=shared_x)
    for panel, part in zip(panels, axes, strict=True):
        experiment = dataclasses.replace(result.experiment, **panel.layout)
        draw_in_range(dataclasses.replace(result, experiment=experiment, lines=tuple(panel.lines)), part)
        part.set_title(panel.title, loc="left")
        if shared_x and part is not axes[-1]:
            part.set_xlabel("")
    last: Axes = axes[-1]
    return last
