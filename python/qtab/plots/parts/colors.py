"""Colors: one per algorithm, sequential ones for ordered parameters, all readable on dark backgrounds; line styles."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.config.choices import ALGORITHM_NAMES, CHOICES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLORS = (
    *("#1f5fa8", "#d1662b", "#2f8f5b", "#8a4fa3", "#b0892b"),
    *("#4b8fa8", "#b03a48", "#5b5b5b", "#7a4f2b", "#c75f9b"),
)
"""Colors that differ in lightness, and that most color-blind readers can distinguish."""

LINE_STYLES: tuple[Any, ...] = (
    "solid",
    (0, (7, 2)),
    (0, (7, 2, 1.2, 2)),
    (0, (2.5, 1.5)),
    (0, (7, 2, 1.2, 2, 1.2, 2)),
)
"""Styles that distinguish lines without their colors: dashes longer or shorter than those of an optimum, and dots."""

SEQUENTIAL = "viridis"
"""The colormap of ordered values."""
_DARK = 0.35
"""A background of less brightness than this is dark."""
_LIGHTENED = 0.45
"""The share of white in the colors on a dark background."""


def color(index: int, ax: "Axes | None" = None) -> Any:
    """Returns the color of a line by its index, lightened if the axes are dark."""
    return readable(COLORS[index % len(COLORS)], ax)


def line_style(index: int) -> Any:
    """Returns the style of a line by its index: the first is solid."""
    return LINE_STYLES[index % len(LINE_STYLES)]


def readable(chosen: str, ax: "Axes | None") -> Any:
    """Returns a color, lightened if the axes are dark."""
    if ax is None or not is_dark(ax):
        return chosen
    from matplotlib.colors import to_hex, to_rgb

    red, green, blue = (part * (1 - _LIGHTENED) + _LIGHTENED for part in to_rgb(chosen))
    return to_hex((red, green, blue))


def text_color() -> Any:
    """Returns the color of text in the current style."""
    from matplotlib import rcParams

    return rcParams["text.color"]


def is_dark(ax: "Axes") -> bool:
    """Returns whether the background is dark: that of the axes, or of the figure behind transparent axes."""
    from matplotlib.colors import to_rgba

    for background in (ax.get_facecolor(), ax.figure.get_facecolor()):
        if to_rgba(background)[3] >= 0.5:
            return brightness(background) < _DARK
    return brightness(ax.title.get_color()) > 0.5  # both are transparent: bright text is meant for dark pages


def brightness(chosen: Any) -> float:
    """Returns the perceived brightness of a color, from 0 to 1."""
    from matplotlib.colors import to_rgb

    red, green, blue = to_rgb(chosen)
    return 0.299 * red + 0.587 * green + 0.114 * blue


def palette(
    keys: Sequence[Any], ax: "Axes", first: int | None = None, colors: Any = None, labels: Sequence[str] | None = None
) -> list[Any]:
    """Returns a color for each line.

    Algorithms have one color each, the same in every plot. Three or more numbers have sequential colors in their
    order. All other lines take the colors in order.

    Args:
        keys: For each line the name of its algorithm, as in the settings or as in ``"Sarsa(λ)"``, a number, or anything
            else.
        ax: The axes to draw on.
        first: The index of the first line's color, whatever the keys; None lets the keys decide.
        colors: The user's choice: a color, a sequence of colors or a mapping of labels to colors; None chooses.
        labels: The labels that such a mapping may name; None means the keys.

    Raises:
        TypeError: if ``colors`` is of the wrong type.
        ValueError: if it holds something other than a color, or too few colors.
    """
    if colors is not None:
        return _given(keys if labels is None else labels, colors)
    if first is None and len(set(keys)) == len(keys):
        algorithms = [algorithm(key) for key in keys]
        if None not in algorithms:
            return [readable(algorithm_color(key), ax) for key in keys]
        if len(keys) > 2 and all(isinstance(key, int | float) and not isinstance(key, bool) for key in keys):
            return sequential(keys, ax)
    return [color((first or 0) + index, ax) for index in range(len(keys))]


def algorithm_color(key: Any) -> str:
    """Returns the color of the algorithm that a label names, the same in every plot; empty for other labels."""
    name = algorithm(key)
    return COLORS[CHOICES["algorithm"].index(name) % len(COLORS)] if name else ""


def algorithm(key: Any) -> str | None:
    """Returns the algorithm that a label names, such as ``"sarsa"`` or ``"True online Sarsa(λ)"``; None for others."""
    return _BY_NAME.get(_plain(str(key)))


def _plain(name: str) -> str:
    """Returns a name without the differences between ``"Q-learning"``, ``"q learning"`` and ``"q_learning"``."""
    return name.lower().replace("-", " ").replace("_", " ")


_BY_NAME = {_plain(name): key for key, written in ALGORITHM_NAMES.items() for name in (key, written)}
"""The algorithms by their names in the settings and in the book."""


def sequential(numbers: Sequence[float], ax: "Axes") -> list[Any]:
    """Returns a color for each number, sequential by size."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    # The ends that would vanish into the background are left out.
    low, high = (0.25, 1.0) if is_dark(ax) else (0.0, 0.85)
    positions = np.linspace(low, high, len(numbers))
    ranks = np.argsort(np.argsort(numbers, kind="stable"), kind="stable")
    return [to_hex(colormaps[SEQUENTIAL](positions[rank])) for rank in ranks]


def _given(labels: Sequence[Any], colors: Any) -> list[Any]:
    from matplotlib.colors import is_color_like

    if is_color_like(colors):
        chosen = [colors] * len(labels)
    elif isinstance(colors, Mapping):
        absent = [label for label in labels if label not in colors]
        if absent:
            raise ValueError(f"colors must have a color for each of {list(labels)}, got none for {absent[0]!r}")
        chosen = [colors[label] for label in labels]
    elif isinstance(colors, Sequence) and not isinstance(colors, str):
        if len(colors) < len(labels):
            raise ValueError(f"colors must hold at least {len(labels)} colors, got {len(colors)}")
        chosen = list(colors[: len(labels)])
    else:
        wanted = "a color, a sequence of colors or a mapping of names to colors"
        error = ValueError if isinstance(colors, str) else TypeError
        raise error(f"colors must be {wanted}, got {colors!r}")
    for candidate in chosen:
        if not is_color_like(candidate):
            raise ValueError(f"colors must hold colors that matplotlib knows, got {candidate!r}")
    return chosen
