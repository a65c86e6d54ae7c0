"""The result of an experiment: the lines of its figure, its table as text, and its points as CSV."""

import csv
import itertools
import math
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab._utils import html
from qtab._utils.data_frames import data_frame
from qtab._utils.files import replacing
from qtab._utils.shown import counted
from qtab.book.description import Description
from qtab.book.line import Line, joined
from qtab.book.runner import FloatArray

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

TEXT_WIDTH = 100
ROUNDING = 1e-14
"""The relative standard error up to which runs differ only by rounding."""
LARGE = 1e7
"""Numbers of at least this size are shown by powers of ten."""
CSV_COLUMNS = ("line", "x", "mean", "standard_error", "runs", "capped_episodes", "diverged_runs")

Draw: TypeAlias = Callable[["Result", "Axes | None"], "Axes"]
"""Draws a result on axes, or on a new figure, and returns the axes."""


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """The result of an experiment. ``str(result)`` is a table with the settings above it."""

    experiment: Description
    lines: tuple[Line, ...]
    runs: int
    """The number of runs of each setting; fewer for a setting whose ``max_runs`` is smaller."""
    seed: int
    """The seed of the first run of each setting."""
    seconds: float
    """The wall-clock time of the experiment."""
    draw: Draw = field(repr=False)
    """Draws the figure."""
    surfaces: Mapping[str, FloatArray] = field(default_factory=dict, repr=False)
    """The surfaces of the figure by title, if it has any."""
    table: str = field(default="", repr=False)
    """The table as text; empty if it is made from the points of the lines."""

    def __repr__(self) -> str:
        """Returns one line; ``str(result)`` is the table."""
        lines, runs = counted(len(self.lines), "line"), counted(self.runs, "run")
        return f"<Result of {self.experiment.heading}: {lines}, {runs} of each setting, seed {self.seed}>"

    def _repr_html_(self) -> str:
        """HTML for notebooks: a table with the lowest and the highest point of each line, and the lines."""
        x, y = self.experiment.x_label, self.experiment.y_label
        columns = ("", "points", f"lowest {y}", f"highest {y}", "runs", "diverged")
        rows = []
        for line in self.lines:
            finite = line.mean[np.isfinite(line.mean)]
            lowest, highest = (f"{finite.min():.5g}", f"{finite.max():.5g}") if len(finite) else ("-", "-")
            rows.append((line.name, len(line.mean), lowest, highest, line.runs, int(line.diverged.sum())))
        drawn = {line.name: line.mean for line in self.lines if line.drawn}
        numbers = itertools.count()
        colors = [html.color(next(numbers)) if line.drawn else "" for line in self.lines]
        return html.listing(self.experiment.heading, columns, rows, html.lines(f"{y} by {x}", drawn), colors)

    def to_pandas(self) -> "pd.DataFrame":
        """Returns all points of all lines as a data frame, with the columns of :meth:`save`.

        Raises:
            ModuleNotFoundError: without pandas; the message names the ``pip install``.
        """
        counts, points = [len(line.x) for line in self.lines], joined(self.lines)
        columns: dict[str, NDArray[Any]] = {
            "line": np.repeat(np.array([line.name for line in self.lines], dtype=object), counts),
            "x": points.x,
            "mean": points.mean,
            "standard_error": points.error,
            "runs": np.repeat(np.array([line.runs for line in self.lines], dtype=np.int64), counts),
            "capped_episodes": points.truncated,
            "diverged_runs": points.diverged,
        }
        return data_frame(columns)

    def __str__(self) -> str:
        return "\n".join([*_head(self), "", *([self.table] if self.table else _rows(self))])

    def save(self, path: Path | str) -> None:
        """Writes all points of all lines to a CSV file, completely or not at all.

        Raises:
            OSError: if the file cannot be written.
        """
        with replacing(Path(path)) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(CSV_COLUMNS)
            for line in self.lines:
                columns = line.x, line.mean, line.error, line.truncated, line.diverged
                for x, mean, error, truncated, diverged in zip(*(column.tolist() for column in columns), strict=True):
                    standard_error = "" if math.isnan(error) else error
                    writer.writerow((line.name, x, mean, standard_error, line.runs, truncated, diverged))

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draws the figure and returns the axes.

        Args:
            ax: The axes to draw on; None creates a new figure.

        Raises:
            ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        """
        return self.draw(self, ax)


def _head(result: Result) -> Iterator[str]:
    experiment = result.experiment
    yield experiment.heading
    for name, text in (("the book", experiment.book), ("unspecified", experiment.unspecified)):
        if text:
            yield from _wrapped(f"{name}: {text}")
    conditions = experiment.conditions([line.runs for line in result.lines], result.runs, result.seed)
    yield from _wrapped(f"{conditions}; {result.seconds:.1f} s")


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, TEXT_WIDTH, initial_indent="  ", subsequent_indent="    ")


def _rows(result: Result) -> list[str]:
    experiment = result.experiment
    has_errors = not all(np.isnan(line.error).all() for line in result.lines)
    head = ["", experiment.x_label, experiment.y_label]
    if has_errors or experiment.counts_failures:
        head.append("std. error")
    if experiment.counts_failures:
        head += ["truncated", "diverged"]
    rows = [head]
    for line in result.lines:
        for index, x in enumerate(line.x):
            if experiment.table_x is not None and x not in experiment.table_x:
                continue
            error = line.error[index]
            if error <= ROUNDING * abs(line.mean[index]):
                error = 0.0  # all runs are equal, up to the rounding of their mean
            row = [
                line.name,
                experiment.x_words.get(x, f"{x:g}"),
                _rounded(line.mean[index], error),
                "-" if math.isnan(error) else _rounded(error, error),
                str(line.truncated[index]),
                str(line.diverged[index]),
            ]
            rows.append(row[: len(head)])
    return aligned(rows)


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Returns the lines of a table: the first column to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]


def _rounded(value: float, error: float) -> str:
    """Returns a number rounded to the first two digits of its standard error."""
    if math.isnan(error) or error <= 0:
        return f"{value:.5g}"
    if abs(value) >= LARGE:
        return f"{value:.2g}"  # a run that diverges
    return f"{value:,.{max(0, 1 - math.floor(math.log10(error)))}f}"
