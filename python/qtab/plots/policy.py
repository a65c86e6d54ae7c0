"""A picture of the greedy policy."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.plots.arrangements import Raster
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.arrangements.raster import DIRECTIONS
from qtab.plots.parts.colors import COLORS, brightness, is_dark
from qtab.plots.parts.labels import below_label, joined
from qtab.plots.parts.own_names import environment_action_names
from qtab.plots.parts.panels import (
    arranged,
    axes_for,
    cell_font_size,
    draw_cells,
    finish_panel,
    shade_unknown,
    write_numbers,
)
from qtab.plots.parts.subject import Drawable
from qtab.results.words import checked_action_names

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def policy(
    run: Drawable | Sequence[Drawable],
    ax: "Axes | None" = None,
    *,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    action_names: Sequence[str] | None = None,
    title: str | None = None,
    step: int = 0,
) -> "Axes":
    """Draws the greedy action of each state: arrows on a map, colors with a legend elsewhere.

    Of several greedy actions the first is shown, which is the one that ``run.predict`` takes; for many seeds the
    most frequent one. States in which nothing was learned are grey, as in :func:`qtab.plots.values`.

    Args:
        run: A run; the runs of many seeds with their tables; or an optimum. A sequence of them makes panels.
        ax: The axes to draw on; None creates a new figure. A sequence needs None.
        at: For observations of more than two components, the values of those that are not axes; see
            :func:`qtab.plots.values`.
        layout: A map for numbered states; see :func:`qtab.plots.values`.
        action_names: A name for each action; None takes those of the environment's attribute ``action_names``, or
            ``run.action_names``. On a map the actions left, right, up and down, and west, east, north and south, are
            arrows.
        title: The title; None names the environment, the algorithm and the seed.
        step: The step of the episode to show, for runs with ``time_aware=True``.

    Returns:
        The axes; of several panels, those of the first.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for one that does not fit the environment, or runs without tables.
    """
    panels = arranged(run, at, layout, title, step)
    names = [
        environment_action_names(subject)
        if action_names is None
        else checked_action_names(subject.action_names, action_names)
        for subject, _ in panels
    ]
    axes = axes_for([raster for _, raster in panels], ax)
    for (subject, raster), panel, named in zip(panels, axes, names, strict=True):
        greedy, handles = subject.greedy_actions(raster.rows), list[Any]()
        shade_unknown(panel, raster, greedy)
        if raster.is_map and raster.has_moves and any(name in DIRECTIONS for name in named):
            draw_moves(panel, raster, greedy[..., np.newaxis] == np.arange(len(named)), named)
        else:
            handles = draw_regions(panel, raster, greedy, named)
        note = joined(raster.note, _initials(named) if raster.is_map and not handles else "")
        finish_panel(panel, raster, subject.name if title is None else title, note)
        if handles:
            _add_legend(panel, handles)
    return axes[0]


def draw_moves(ax: "Axes", raster: Raster, taken: NDArray[np.bool_], names: Sequence[str]) -> None:
    """Draws an arrow for each action that is taken in a cell, or the letters of an action that is no move.

    Args:
        ax: The axes.
        raster: A map.
        taken: (ny, nx, actions): whether each action is taken. Several arrows start in the middle of the cell.
        names: (actions,): the names of the actions.
    """
    xs, ys = np.meshgrid(*raster.centers)
    color, letter_color = ("#9ecbff", "#ffb26b") if is_dark(ax) else ("#1f5fa8", "#b3480f")
    cells = max(xs.shape)
    several = taken.sum(axis=-1) > 1
    starts, ends = np.where(several, 0.0, -0.32), np.where(several, 0.42, 0.32)
    for action, name in enumerate(names):
        chosen = taken[..., action]
        if name in DIRECTIONS:
            right, down = DIRECTIONS[name]
            start, end = starts[chosen], ends[chosen]
            ax.quiver(
                xs[chosen] + start * right,
                ys[chosen] + start * down,
                (end - start) * right,
                (end - start) * down,
                angles="xy",
                scale_units="xy",
                scale=1,
                width=0.05 if cells <= 12 else 0.09,
                units="xy",
                headwidth=4.5 if cells <= 12 else 4,
                headlength=4.5 if cells <= 12 else 3.5,
                headaxislength=4 if cells <= 12 else 3.2,
                color=color,
                zorder=4,
            )
        else:
            letters = _letters(name)
            size = max(5.0, cell_font_size(ax, raster))
            style: dict[str, Any] = {"color": letter_color, "fontsize": size, "fontweight": "bold"}
            for x, y in zip(xs[chosen], ys[chosen], strict=True):
                ax.text(x, y, letters, ha="center", va="center", zorder=7, **style)


def _initials(names: Sequence[str]) -> str:
    """Returns the meaning of the letters in the cells of a map."""
    return ", ".join(f"{_letters(name)}: {name}" for name in names if name not in DIRECTIONS and " " in name)


def _letters(name: str) -> str:
    return "".join(word[0].upper() for word in name.split()) if " " in name else name[:3]


def action_colors(count: int, ordered: bool) -> list[Any]:
    """Returns a color for each action; from blue through pale yellow to orange if their order has a meaning."""
    from matplotlib import colormaps

    if count == 2:
        return [COLORS[0], COLORS[1]]
    if count == 3 and ordered:
        return [COLORS[0], "#f5e6a8", COLORS[1]]
    if ordered:
        return [colormaps["cividis"](index / (count - 1)) for index in range(count)]
    return (
        list(COLORS[:count]) if count <= len(COLORS) else [colormaps["turbo"](index / count) for index in range(count)]
    )


def draw_regions(ax: "Axes", raster: Raster, greedy: NDArray[np.int64], names: Sequence[str]) -> list[Any]:
    """Draws (ny, nx) actions in colors; returns the handles of a legend, none if the picture has labels instead."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    ordered = any(character.isdigit() for character in names[-1]) or "no push" in names
    colors = action_colors(len(names), ordered and not names[0].startswith("action"))
    norm = BoundaryNorm(np.arange(len(names) + 1) - 0.5, len(names))
    known = np.where(greedy < 0, np.nan, greedy)
    image = draw_cells(ax, raster, known, ListedColormap(colors), norm)
    if raster.parts:
        _label_regions(ax, raster, greedy, names, colors)
        return []
    if raster.has_numbers and (raster.has_moves or not raster.is_map):
        write_numbers(ax, raster, known, image, lambda action: names[int(action)], "small")
        return []
    present = [index for index in range(len(names)) if (greedy == index).any() or len(names) <= 8]
    return [Patch(color=colors[index], label=names[index]) for index in present]


def _add_legend(ax: "Axes", handles: list[Any]) -> None:
    """Adds the legend below the label of the x axis."""
    ax.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0, 0),
        bbox_transform=below_label(ax),
        ncols=min(len(handles), 4),
        frameon=False,
        fontsize="small",
        handlelength=1.2,
        borderaxespad=0,
        borderpad=0,
    )


def _label_regions(
    ax: "Axes", raster: Raster, greedy: NDArray[np.int64], names: Sequence[str], colors: Sequence[Any]
) -> None:
    """Writes the action into its region, at the widest place, in each part of the picture, as in the book."""
    xs, ys = raster.centers
    for part in raster.parts.values():
        for action, name in enumerate(names):
            spans = [_longest(line == action) for line in greedy[part]]
            length = max(stop - start for start, stop in spans)
            if length > 0:
                widest = [row for row, (start, stop) in enumerate(spans) if stop - start == length]
                row = widest[len(widest) // 2]
                dark = brightness(colors[action]) < 0.6
                style: dict[str, Any] = {"color": "#ffffff" if dark else "#101010", "ha": "center", "va": "center"}
                x = xs[slice(*spans[row])].mean()
                ax.text(x, ys[part][row], name.upper(), fontweight="bold", zorder=7, **style)


def _longest(matches: NDArray[np.bool_]) -> tuple[int, int]:
    """Returns the start and the end of the longest stretch of True."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], matches, [False]]).astype(np.int8)))
    stretches = list(zip(ends[::2].tolist(), ends[1::2].tolist(), strict=True))
    return max(stretches, key=lambda stretch: stretch[1] - stretch[0], default=(0, 0))
