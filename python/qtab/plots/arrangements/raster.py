"""The points of a picture, and the states that they show."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LIGHT, DARK = "#f2f2f2", "#1a1a1a"
"""The colors of letters and lines in dark and in light styles."""
DIRECTIONS: Mapping[str, tuple[int, int]] = {
    "left": (-1, 0),
    "right": (1, 0),
    "up": (0, -1),
    "down": (0, 1),
    "west": (-1, 0),
    "east": (1, 0),
    "north": (0, -1),
    "south": (0, 1),
}
"""The actions that are moves on a map: to the right and downwards, in cells."""


def outline(ink: str) -> list[Any]:
    """Returns path effects that keep letters readable on any color: an outline of the opposite brightness."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=2, foreground="#101010" if ink == LIGHT else "#ffffff")]


def _nothing(ax: "Axes", ink: str) -> None:
    """Draws nothing."""


@dataclass(frozen=True, eq=False)
class Raster:
    """The points of a picture, in rows and columns, and the states that they show."""

    x_edges: NDArray[np.float64]
    """(nx + 1,): the edges of the columns."""
    y_edges: NDArray[np.float64]
    """(ny + 1,): the edges of the rows."""
    rows: NDArray[Any]
    """(ny, nx, n_active): the active rows of the table at each point, -1 where there is no state; or the values of
    weighted features."""
    locate: Callable[[NDArray[Any]], NDArray[np.float64]]
    """Returns (n, 2): the positions in the picture of observations, (n, d) or (n,)."""
    labels: tuple[str, str] = ("", "")
    """The labels of the axes."""
    note: str = ""
    """The values of the components that the picture does not show."""
    decorate: Callable[["Axes", str], None] = _nothing
    """Draws letters, walls and ticks in a color."""
    bar_at: float = 1.02
    """The x position of a color bar, in widths of the axes."""
    parts: Mapping[str, slice] = field(default_factory=dict)
    """The rows of each part, for a picture with labeled regions."""
    is_map: bool = False
    """Whether columns and rows are places, so that moves are arrows; the rows then run downwards."""
    has_moves: bool = True
    """Whether moves are arrows on a map: not if it is unknown which way they lead."""
    has_numbers: bool = False
    """Whether there is room for a number in each cell."""
    has_gaps: bool = False
    """Whether it has several parts with gaps between them, which a line must not cross."""
    observations: NDArray[Any] | None = None
    """(ny * nx, d): the observation at each point; None if the rows were counted directly."""
    size: tuple[float, float] = (8.0, 4.5)
    """The width and the height of a figure that suits the picture, in inches."""

    @property
    def has_state(self) -> NDArray[np.bool_]:
        """(ny, nx): whether there is a state at each point. Weighted features are those of a Box, full of states."""
        if self.rows.dtype.kind == "f":
            return np.ones(self.rows.shape[:2], np.bool_)
        return np.asarray((self.rows >= 0).all(axis=-1))

    @property
    def centers(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The centers of the columns and of the rows."""
        return (self.x_edges[1:] + self.x_edges[:-1]) / 2, (self.y_edges[1:] + self.y_edges[:-1]) / 2

    def frame(self, ax: "Axes", ink: str) -> None:
        """Sets the limits, the labels and the direction of the axes, and draws the marks of the arrangement."""
        ax.set_xlabel(self.labels[0])
        ax.set_ylabel(self.labels[1])
        margin = 0.08 if self.has_gaps else 0.0
        ax.set_xlim(self.x_edges[0] - margin, self.x_edges[-1] + margin)
        low, high = self.y_edges[0] - margin, self.y_edges[-1] + margin
        ax.set_ylim(*((high, low) if self.is_map else (low, high)))
        if self.is_map:
            ax.set_aspect("equal")
            ax.spines[:].set_visible(False)
            ax.tick_params(length=0)
        self.decorate(ax, ink)
