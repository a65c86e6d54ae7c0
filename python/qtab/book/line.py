"""A line of a figure: the means of runs at some points, with their standard errors."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils.shown import counted
from qtab.book.runner import FloatArray


@dataclass(frozen=True, kw_only=True)
class LineStyle:
    """The style of a line."""

    drawn: bool = True
    """Whether the figure shows the line; the table always does."""
    method: str = ""
    """The method that decides the color of the line; empty means the name of the line."""
    dashed: bool = False
    """Whether the line is dashed."""
    broad: bool = False
    """Whether the line is broad and behind the others, which coincide with it at many points."""
    named: bool = True
    """Whether the figure names the line. Runs that differ only in their seeds have no names in it."""


@dataclass(frozen=True, eq=False, repr=False)
class Line(LineStyle):
    """A line of a figure; all arrays are (points,)."""

    name: str
    x: FloatArray
    mean: FloatArray
    """The mean over the runs."""
    error: FloatArray
    """The standard error of the mean; NaN with a single run."""
    runs: int
    truncated: "NDArray[np.int64]"
    """The number of truncated episodes of each point."""
    diverged: "NDArray[np.int64]"
    """The number of runs of the setting that diverged."""

    def __repr__(self) -> str:
        """Returns one line of text, without the points."""
        count = len(self.x)
        points = counted(count, "point")
        if count:
            points += f" from {self.x[0]:g} to {self.x[-1]:g}"
        return f"<Line {self.name!r}: {points}, {counted(self.runs, 'run')}>"


def line_from_samples(
    name: str,
    x: ArrayLike,
    samples: FloatArray,
    truncated: "NDArray[np.int64] | int" = 0,
    diverged: int = 0,
    style: LineStyle | None = None,
) -> Line:
    """Returns the line through the means of runs.

    Args:
        name: The name of the line.
        x: (points,): the x coordinates.
        samples: (runs, points): the measurements.
        truncated: The number of truncated episodes, for all points or (points,) for each.
        diverged: The number of runs that diverged.
        style: The style of the line; None means the default.
    """
    runs, points = samples.shape
    with np.errstate(invalid="ignore", over="ignore"):  # runs that diverged can have infinite errors
        error = samples.std(axis=0, ddof=1) / np.sqrt(runs) if runs > 1 else np.full(points, np.nan)
    return Line(
        name,
        np.asarray(x, np.float64),
        samples.mean(axis=0),
        error,
        runs,
        np.broadcast_to(truncated, points),
        np.broadcast_to(diverged, points),
        **{one.name: getattr(style, one.name) for one in dataclasses.fields(LineStyle)} if style is not None else {},
    )


def exact_line(name: str, x: ArrayLike, values: ArrayLike) -> Line:
    """Returns a line without standard errors."""
    return line_from_samples(name, x, np.asarray(values, np.float64)[np.newaxis])


def joined(parts: Sequence[Line]) -> Line:
    """Returns the points of several settings as one line."""
    names = ("x", "mean", "error", "truncated", "diverged")
    columns: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return dataclasses.replace(parts[0], **columns)
