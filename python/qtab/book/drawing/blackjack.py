"""Policies and values of blackjack, as Figure 5.2 shows them."""

from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.drawing.titles import title_figure
from qtab.book.result import Result
from qtab.plots.axes import shown_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DEALER = ("A", *map(str, range(2, 11)))
"""The dealer's cards."""
USABLE = ("usable ace", "no usable ace")
_FIRST_SUM = 11
_FIRST_VALUE = 12
"""The lowest sum of the surfaces: below it the player always hits."""
_COLORS = ("#d9e4f2", "#f3c9a6")
_NAMES = ("STICK", "HIT")


def draw_blackjack(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the policy and the values, with and without a usable ace, in a new figure; returns the last axes.

    ``result.surfaces`` holds (actions, sums, dealer's cards) for both.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if ``ax`` is not None.
    """
    if ax is not None:
        raise ValueError(f"ax must be None for {result.experiment.name}, which creates four axes")
    from matplotlib.colors import ListedColormap

    figure = shown_figure(9, 7.5)
    title_figure(figure, result.experiment.heading)
    cards = np.arange(1, len(DEALER) + 1)
    axes: Any = None
    for row, (name, values) in enumerate(result.surfaces.items()):
        sums = np.arange(_FIRST_SUM, _FIRST_SUM + values.shape[1])
        # There is no usable ace below 12.
        policy = np.where((values == 0).all(axis=0), np.nan, values.argmax(axis=0))
        axes = figure.add_subplot(2, 2, 2 * row + 1)
        axes.pcolormesh(cards, sums, policy, cmap=ListedColormap(_COLORS), vmin=0, vmax=1, edgecolors="white")
        for action, word in enumerate(_NAMES):
            where = np.argwhere(policy == action)
            if len(where):
                height, across = np.median(where, axis=0)
                axes.text(cards[0] + across, sums[0] + height, word, ha="center", va="center", color="black")
        axes.set_xticks(cards, DEALER)
        axes.set_yticks(sums)
        axes.set(xlabel="dealer's card", ylabel="player's sum", title=f"policy, {name}")
        axes.title.set_fontsize("medium")
        axes.tick_params(labelsize="small")
        axes = figure.add_subplot(2, 2, 2 * row + 2, projection="3d")
        surface = values.max(axis=0)[_FIRST_VALUE - _FIRST_SUM :]
        x, y = np.meshgrid(cards, sums[_FIRST_VALUE - _FIRST_SUM :])
        axes.plot_surface(x, y, surface, cmap="viridis", vmin=-1, vmax=1, rcount=len(surface), ccount=len(cards))
        axes.set_xticks(cards, DEALER)
        axes.set(
            xlabel="dealer's card", ylabel="player's sum", zlim=(-1, 1), zticks=(-1, 0, 1), title=f"values, {name}"
        )
        axes.title.set_fontsize("medium")
        axes.tick_params(labelsize="x-small")
        axes.set_box_aspect(None, zoom=0.85)
    drawn: Axes = axes
    return drawn
