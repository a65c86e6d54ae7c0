"""The title of a figure with several axes."""

from typing import Any

from qtab.plots.labels import fitted

LEFT = 0.02
"""Where it begins, as a part of the width."""


def title_figure(figure: Any, title: str) -> None:
    """Writes the title of a figure with several axes where figures with one have theirs: on the left, in bold."""
    from matplotlib.font_manager import FontProperties

    size = FontProperties(size="large").get_size_in_points()
    room = (1 - 2 * LEFT) * figure.get_figwidth() * 72
    figure.suptitle(fitted(title, room, size, "bold"), x=LEFT, ha="left", fontweight="bold", fontsize=size)
