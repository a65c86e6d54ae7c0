"""Taxi's 500 states as twenty small maps: one for each place of the passenger and each destination."""

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.envs.toy_text.taxi import MAP
from numpy.typing import NDArray

from qtab.plots.arrangements.raster import Raster
from qtab.results.words import PLACES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIDE, PASSENGERS, DESTINATIONS = 5, 5, 4
PITCH = SIDE + 1
"""The distance from one map to the next, which leaves one cell between them."""
LOCATIONS = ((0, 0), (0, 4), (4, 0), (4, 3))
"""The row and column of each place."""


def taxi() -> Raster:
    """Returns the raster of all states: columns of maps by the place of the passenger, rows by the destination."""
    height, width = PITCH * DESTINATIONS - 1, PITCH * PASSENGERS - 1
    rows = np.full((height, width), -1)
    for state in range(500):
        x, y = _place(np.array(state))
        rows[int(y), int(x)] = state

    def locate(observed: NDArray[Any]) -> NDArray[np.float64]:
        places: NDArray[np.float64] = np.stack(_place(np.asarray(observed).ravel()), axis=-1) + np.float64(0.5)
        return places

    return Raster(
        x_edges=np.arange(width + 1.0),
        y_edges=np.arange(height + 1.0),
        rows=rows[..., np.newaxis],
        locate=locate,
        labels=("passenger at", "destination"),
        decorate=_decorate,
        is_map=True,
        has_gaps=True,
        note="solid square: destination, dashed square: passenger",
        size=(8.6, 6.6),
    )


def _place(states: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Decodes states as Gymnasium encodes them: ((row * 5 + column) * 5 + passenger) * 4 + destination."""
    rest, destination = np.divmod(states, DESTINATIONS)
    rest, passenger = np.divmod(rest, PASSENGERS)
    row, column = np.divmod(rest, SIDE)
    return PITCH * passenger + column, PITCH * destination + row


def _decorate(ax: "Axes", ink: str) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Rectangle

    columns = range(1, SIDE)
    walls = [(row, column) for row, line in enumerate(MAP[1:-1]) for column in columns if line[2 * column] == "|"]
    corners = [(PITCH * passenger, PITCH * destination) for destination in range(4) for passenger in range(5)]
    frames = [[(x, y), (x + SIDE, y), (x + SIDE, y + SIDE), (x, y + SIDE), (x, y)] for x, y in corners]
    inner = [[(x + column, y + row), (x + column, y + row + 1)] for x, y in corners for row, column in walls]
    for lines, width in ((frames, 0.8), (inner, 1.6)):
        ax.add_collection(LineCollection(lines, colors=ink, linewidths=width, zorder=5), autolim=False)
    for x, y in corners:
        for index, (row, column) in enumerate(LOCATIONS):
            if index in (x // PITCH, y // PITCH):
                style: Any = "-" if index == y // PITCH else (0, (2, 1.5))
                corner = x + column + 0.06, y + row + 0.06
                square = Rectangle(
                    corner, 0.88, 0.88, fill=False, edgecolor=ink, linestyle=style, linewidth=1.3, zorder=6
                )
                ax.add_patch(square)
    ax.set_xticks(PITCH * np.arange(PASSENGERS) + 2.5, [*PLACES, "in the taxi"])
    ax.set_yticks(PITCH * np.arange(DESTINATIONS) + 2.5, PLACES)
