"""Blackjack as Sutton & Barto draw it (2nd ed., Figure 5.2): the dealer's card against the player's sum."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.plots.arrangements.raster import Raster

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHAPE = (32, 11, 2)
"""The cells of Gymnasium's observation: the player's sum, the dealer's card, whether an ace is usable."""
SUMS, CARDS = range(12, 22), range(1, 11)
"""The sums and cards in the picture; below a sum of 12 the player always hits."""
LOWER = len(SUMS) + 1
"""The first row of the upper part, with a usable ace; one row between the parts is empty."""


def blackjack() -> Raster:
    """Returns the raster of two parts, one above the other: with a usable ace, and without one."""
    rows = np.full((2 * len(SUMS) + 1, len(CARDS)), -1)
    for usable in (0, 1):
        for y, player in enumerate(SUMS):
            for x, card in enumerate(CARDS):
                rows[LOWER * usable + y, x] = np.ravel_multi_index((player, card, usable), SHAPE)

    def locate(observed: NDArray[Any]) -> NDArray[np.float64]:
        player, card, usable = np.asarray(observed, np.int64).T
        return np.stack([card - CARDS[0], player - SUMS[0] + LOWER * usable], axis=-1) + 0.5

    return Raster(
        x_edges=np.arange(len(CARDS) + 1.0),
        y_edges=np.arange(len(rows) + 1.0),
        rows=rows[..., np.newaxis],
        locate=locate,
        labels=("dealer showing", "player's sum"),
        decorate=_decorate,
        bar_at=1.09,
        parts={"no usable ace": slice(0, len(SUMS)), "usable ace": slice(LOWER, LOWER + len(SUMS))},
        has_gaps=True,
        size=(5.6, 6.6),
    )


def _decorate(ax: "Axes", ink: str) -> None:
    from matplotlib.patches import Rectangle

    ax.set_xticks(np.arange(len(CARDS)) + 0.5, ["A", *map(str, CARDS[1:])])
    positions = [LOWER * usable + y + 0.5 for usable in (0, 1) for y in range(len(SUMS))]
    ax.set_yticks(positions, [str(player) for _ in (0, 1) for player in SUMS])
    for usable, text in ((0, "no usable ace"), (1, "usable ace")):
        y = LOWER * usable
        ax.add_patch(Rectangle((0, y), len(CARDS), len(SUMS), fill=False, edgecolor=ink, linewidth=0.8, zorder=5))
        ax.text(len(CARDS) + 0.15, y + len(SUMS) / 2, text, rotation=270, va="center", color=ink)
    ax.spines[:].set_visible(False)
    ax.tick_params(length=0, labelsize="small")
