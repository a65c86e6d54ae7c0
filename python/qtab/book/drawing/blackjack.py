"""Blackjack in the book's figures: the states with a usable ace above those without one."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.book.drawing.figures import figure_of_several
from qtab.book.result import Result
from qtab.plots.arrangements import Raster
from qtab.plots.arrangements.blackjack import blackjack
from qtab.plots.parts.panels import color_bar, draw_heat_map, finish_panel
from qtab.plots.policy import draw_regions

if TYPE_CHECKING:
    from matplotlib.axes import Axes

USABLE = ("usable ace", "no usable ace")
ACTIONS = ("stick", "hit")
Parts = Mapping[str, NDArray[Any]]
"""(sums from 12 to 21, dealer's cards) for each of ``USABLE``."""


def draw_blackjack(
    result: Result, ax: "Axes | None", values: Mapping[str, Parts], policies: Mapping[str, Parts]
) -> "Axes":
    """Draws a panel for each policy and for the values of each title in a new figure; returns the last axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if ``ax`` is not None.
    """
    raster, count = blackjack(), len(policies) + len(values)
    figure = figure_of_several(result, ax, raster.size[0] * count, raster.size[1])
    from matplotlib.colors import Normalize

    axes: Any = figure.subplots(1, count)
    for part, (title, policy) in zip(axes, policies.items(), strict=False):
        draw_regions(part, raster, np.nan_to_num(_grid(raster, policy), nan=-1).astype(np.int64), ACTIONS)
        finish_panel(part, raster, title)
    for part, (title, parts) in zip(axes[len(policies) :], values.items(), strict=True):
        image = draw_heat_map(part, raster, _grid(raster, parts), Normalize(-1, 1), title, None)
    color_bar(axes[-1:], raster, image, "value")
    last: Axes = axes[-1]
    return last


def _grid(raster: Raster, parts: Parts) -> NDArray[np.float64]:
    """Returns (ny, nx): the numbers of both parts; NaN between them."""
    grid = np.full(raster.rows.shape[:2], np.nan)
    for name, rows in raster.parts.items():
        grid[rows] = parts[name]
    return grid
