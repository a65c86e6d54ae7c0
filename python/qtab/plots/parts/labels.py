"""Titles, labels and legends that fit axes of every size, and cover neither each other nor the data."""

import re
from typing import TYPE_CHECKING, Any

from qtab._utils import checks
from qtab.plots.parts.colors import text_color

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.text import Text

CHARACTER = 0.6
"""The mean width of a character, in font sizes."""
HANDLE = 5.0
"""The width of a legend's line and of the space around it, in font sizes."""
MAX_LEGEND = 0.6
"""The largest part of the axes' height that a legend inside them may take."""
_LEGEND_SIZES = (1.0, 0.85, 0.7)
"""Font sizes, relative to the default, to try in turn if a legend is too high."""
_NOTE = "qtab-note"


def check_title(title: str | None) -> None:
    """Checks the argument ``title`` of a plot with a default title.

    Raises:
        TypeError: if it is neither None nor a string.
    """
    if title is not None:
        checks.instance("title", title, str)


def finish(
    ax: "Axes", x_label: str, y_label: str, title: str = "", *, note: str = "", legend_title: str = ""
) -> "Axes":
    """Adds labels, titles, a grid and a legend to the axes, removes the top and right spines, and returns the axes.

    Args:
        ax: The axes.
        x_label: The label of the x axis.
        y_label: The label of the y axis.
        title: The title, above the axes on the left.
        note: A smaller title on the right, or below the title if there is not enough room beside it.
        legend_title: The title of the legend.
    """
    width, height = _size(ax)
    ax.set_xlabel(fitted(x_label, width, _font_size(ax.xaxis.label)))
    ax.set_ylabel(fitted(y_label, height, _font_size(ax.yaxis.label)))
    add_titles(ax, title, note)
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    add_legend(ax, legend_title)
    return ax


def joined(*parts: str, separator: str = "; ") -> str:
    """Returns the parts that are not empty, joined."""
    return separator.join(part for part in parts if part)


def earlier_limits(ax: "Axes") -> tuple[float, float] | None:
    """Returns the limits of an x axis on which something is drawn, here or on axes that share it; else None."""
    has_data = any(sibling.has_data() for sibling in ax.get_shared_x_axes().get_siblings(ax))
    return ax.get_xlim() if has_data else None


def set_x_limits(ax: "Axes", left: float, right: float, earlier: tuple[float, float] | None) -> None:
    """Sets the limits of the x axis so that they include those of earlier plots, if there are any."""
    ends = (left, right) if earlier is None else (min(left, earlier[0]), max(right, earlier[1]))
    ax.set_xlim(*ends)


def episode_ticks(ax: "Axes") -> None:
    """Labels the x axis with whole numbers of episodes, as many as fit."""
    from matplotlib.ticker import MaxNLocator

    width, _ = _size(ax)
    longest = len(f"{max(ax.get_xlim()):,.0f}") + 2
    size = _font_size(ax.xaxis.label)
    count = max(1, min(10, int(width / (longest * CHARACTER * size))))
    ax.xaxis.set_major_locator(MaxNLocator(count, integer=True, steps=[1, 2, 2.5, 5, 10]))
    ax.xaxis.set_major_formatter("{x:,.0f}")


def category_ticks(ax: "Axes", names: list[str]) -> None:
    """Labels the positions 0, 1, ... of the x axis with names, broken at underscores if there is little room."""
    width, _ = _size(ax)
    ax.set_xlim(-0.5, len(names) - 0.5)
    size = _font_size(ax.xaxis.label)
    room = int(width / len(names) / (CHARACTER * size)) - 1
    broken = [_broken(name, room) for name in names]
    if max(len(line) for name in broken for line in name.split("\n")) > room + 1:
        ax.set_xticks(range(len(names)), names, rotation=90)
    else:
        ax.set_xticks(range(len(names)), broken)


def fitted(text: str, points: float, size: float, weight: str = "normal") -> str:
    """Breaks a text into lines that are at most ``points`` points wide in a font size."""
    width = _width(text, size, weight)
    if width <= points:
        return text
    # A line can have wider letters than the rest.
    return _broken(text, max(10, int(0.95 * points * len(text) / width)))


def _width(text: str, size: float, weight: str = "normal") -> float:
    """Returns the width of a line of text in points."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(size=size, weight=weight)
    return float(text_to_path.get_text_width_height_descent(text, font, False)[0])


def _broken(text: str, room: int) -> str:
    """Breaks a text into lines of at most ``room`` characters, at spaces and in longer words at underscores."""
    lines = [""]
    for word in text.split():
        space = " " if lines[-1] else ""
        if len(lines[-1]) + len(space) + len(word) <= room:
            lines[-1] += space + word
            continue
        lines.append("")
        for part in re.findall(r"[^_]+_*|_+", word):
            if len(lines[-1]) + len(part) > room:
                lines.append("")
            lines[-1] += part
    return "\n".join(filter(None, lines))


def add_titles(ax: "Axes", title: str, note: str) -> None:
    """Writes a title and a note side by side, or one below the other if they would overlap."""
    from matplotlib import rcParams

    for text in list(ax.texts):
        if text.get_gid() == _NOTE:
            text.remove()
    size = _font_size(ax.title)
    small = size / 1.2
    widths = _width(title, size, "bold"), _width(note, small)
    if max(widths) > _size(ax)[0] and (engine := ax.figure.get_layout_engine()) is not None:
        engine.execute(ax.figure.figure)  # which can make the axes wider
    room, _ = _size(ax)
    style: dict[str, Any] = {"fontsize": small, "color": text_color(), "alpha": 0.7}
    pad = rcParams["axes.titlepad"]
    is_wide = sum(widths) + 2 * size <= room
    ax.set_title(note if is_wide else "", loc="right", pad=pad, **style)
    if note and not is_wide:
        lines = fitted(note, room, small)
        text = ax.annotate(
            lines, (0, 1), (0, pad), xycoords="axes fraction", textcoords="offset points", va="bottom", **style
        )
        text.set_gid(_NOTE)
        pad += (lines.count("\n") + 1) * 1.25 * small + 0.3 * small
    if title:
        ax.set_title(fitted(title, room, size, "bold"), loc="left", fontweight="bold", pad=pad)


def add_legend(ax: "Axes", title: str = "") -> None:
    """Adds a legend of all labelled artists where it covers nothing.

    In a figure with a layout engine, which makes room for it, it lies below the x label. In others it lies at the top
    inside the axes, and the y axis is extended above the data, unless the user has set its limits.
    """
    handles, names = ax.get_legend_handles_labels()
    if not handles and not title:
        return
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    normal = FontProperties(size=rcParams["legend.fontsize"]).get_size_in_points()
    has_layout = ax.figure.get_layout_engine() is not None
    for size in (scale * normal for scale in _LEGEND_SIZES):
        legend = _legend(ax, handles, names, title, size, has_layout)
        share = _share(ax, legend)
        if share <= MAX_LEGEND:
            break
    shown = len(names)
    while share > MAX_LEGEND and shown > 1:
        shown = min(shown - 1, int(shown * MAX_LEGEND / share) or 1)
        more = joined(title, f"{len(names) - shown} more not listed")
        legend = _legend(ax, handles[:shown], names[:shown], more, size, has_layout)
        share = _share(ax, legend)
    for handle in legend.legend_handles:
        if handle is not None:
            handle.set_alpha(1)
    if not has_layout and ax.get_autoscaley_on():
        _extend_upwards(ax, min(share, MAX_LEGEND))


def _legend(ax: "Axes", handles: Any, names: list[str], title: str, size: float, has_layout: bool) -> Any:
    """Adds a legend in a font size, below the axes or inside them, with as many columns as fit."""
    width, _ = _size(ax)
    room = 0.9 * width  # the layout can move the axes to the right once the legend is there
    labels = [fitted(name, room - HANDLE * size, size) for name in names]
    longest = max((len(line) for label in labels for line in label.split("\n")), default=1)
    style: dict[str, Any] = {
        **{"fontsize": size, "title": fitted(title, room, size) or None, "title_fontsize": size, "alignment": "left"},
        **{"edgecolor": "none", "framealpha": 0.85, "columnspacing": 1.5, "handlelength": 3.0},
        "ncols": max(1, min(len(labels), int(width / ((longest * CHARACTER + HANDLE) * size)))),
    }
    if not has_layout:
        style |= {"loc": "upper left" if ax.get_autoscaley_on() else "best", "borderaxespad": 0.3}
        return ax.legend(handles, labels, **style)
    style |= {"loc": "upper left", "bbox_to_anchor": (0, 0), "borderaxespad": 0, "borderpad": 0}
    return ax.legend(handles, labels, bbox_transform=below_label(ax), **style)


def _share(ax: "Axes", legend: Any) -> float:
    """Returns the height of a legend in heights of the axes."""
    _, height = _size(ax)
    return float(legend.get_window_extent().height / (height * ax.figure.dpi / 72)) + 0.02


def below_label(ax: "Axes") -> Any:
    """Returns the transform with its origin below the ticks and the label of the x axis, however high the axes are."""
    from matplotlib.transforms import ScaledTranslation

    box = ax.xaxis.get_tightbbox()
    depth = 0.0 if box is None else max(0.0, ax.get_window_extent().y0 - box.y0) / ax.figure.dpi
    return ax.transAxes + ScaledTranslation(0, -depth - 4 / 72, ax.figure.dpi_scale_trans)


def _extend_upwards(ax: "Axes", share: float) -> None:
    """Moves the upper limit of the y axis so that the data leave a share of the height free."""
    transform = ax.yaxis.get_transform()
    low, high = transform.transform(ax.get_ylim())
    top = transform.inverted().transform([low + (high - low) / (1 - share)])[0]
    ax.set_ylim(top=float(top), auto=True)  # a later plot on the same axes sets the limits again


def _size(ax: "Axes") -> tuple[float, float]:
    """Returns the width and the height of the axes in points."""
    box = ax.get_window_extent()
    return box.width * 72 / ax.figure.dpi, box.height * 72 / ax.figure.dpi


def _font_size(text: "Text") -> float:
    """Returns the size of a text in points, even if it was set by a name such as ``"small"``."""
    return float(text.get_fontsize())
