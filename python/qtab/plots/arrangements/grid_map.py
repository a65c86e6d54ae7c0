"""Discrete states on their map: FrozenLake, CliffWalking and grid worlds."""

import math
from collections.abc import Sequence
from contextlib import closing
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.envs.registry import spec_of_run
from qtab.plots.arrangements.raster import Raster, outline
from qtab.plots.parts.subject import Subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Layout = Sequence[str] | tuple[int, int]
"""A map: rows of text, a letter for each state, or the numbers of rows and columns."""

NAMES = {"S": "S", "G": "G", "H": "hole", "C": "cliff"}
"""The text on the cells with these letters; other letters are ground."""
FILLS = {"G": "#2f8f5b", "H": "#4b6f9c", "C": "#8a6a4a"}
"""The colors of these cells."""
NO_STATE = "HGC#"
"""The letters of cells in which no action is taken."""


def checked_layout(layout: Any, states: int) -> tuple[str, ...]:
    """Returns a map as rows of letters.

    Raises:
        TypeError: if it is neither rows of text nor two integers.
        ValueError: if the number of cells differs from the number of states.
    """
    if isinstance(layout, str | bytes) or not isinstance(layout, Sequence):
        raise TypeError(f"layout must be rows of text, or the numbers of rows and columns, got {layout!r}")
    if len(layout) == 2 and all(hasattr(count, "__index__") for count in layout):
        rows = ("." * int(layout[1]),) * int(layout[0])
    elif layout and all(isinstance(row, str) for row in layout):
        rows = tuple(layout)
    else:
        raise TypeError(f"layout must be rows of text, or the numbers of rows and columns, got {layout!r}")
    if len({len(row) for row in rows}) != 1 or sum(map(len, rows)) != states:
        raise ValueError(f"layout must have {states} cells in rows of one length, one for each state, got {layout!r}")
    return rows


def known_layout(subject: Subject) -> tuple[str, ...]:
    """Returns the map of FrozenLake or CliffWalking."""
    states = subject.discretizer.n_rows
    kwargs = subject.env_kwargs
    side = math.isqrt(states)
    if kwargs.get("map_name", "") is None and kwargs.get("desc") is None:
        return ("." * side,) * side  # a random map: a new environment would draw another one
    with closing(gym.make(spec_of_run(subject.env), **{**kwargs, "render_mode": None})) as made:
        env: Any = made.unwrapped
        if hasattr(env, "desc"):
            return tuple(b"".join(row).decode() for row in env.desc)
        return tuple(
            "".join(
                "G" if cell == env.nS - 1 else "C" if cliff else "S" if cell == env.start_state_index else "."
                for cell, cliff in enumerate(row, start)
            )
            for start, row in zip(range(0, env.nS, env.shape[1]), env._cliff, strict=True)
        )


def grid_map(layout: Sequence[str], first: int = 0) -> Raster:
    """Returns the raster of a map with a cell for each state; states are numbered from ``first``, row by row."""
    height, width = len(layout), len(layout[0])
    letters = np.array([list(row) for row in layout])
    rows = np.where(np.isin(letters, list(NO_STATE)), -1, np.arange(height * width).reshape(height, width))

    def locate(observed: NDArray[Any]) -> NDArray[np.float64]:
        states = np.asarray(observed).ravel() - first
        return np.stack([states % width, states // width], axis=-1) + 0.5

    def decorate(ax: "Axes", ink: str) -> None:
        _draw_letters(ax, letters, ink)
        line: dict[str, Any] = {"colors": ink, "linewidth": 0.6, "alpha": 0.5, "zorder": 5}
        ax.hlines(np.arange(height + 1), 0, width, **line)
        ax.vlines(np.arange(width + 1), 0, height, **line)
        ax.set_xticks(np.arange(width) + 0.5, [str(x) for x in range(width)])
        ax.set_yticks(np.arange(height) + 0.5, [str(y) for y in range(height)])

    side = 8 * min(1.0, width / max(height, 8))
    return Raster(
        x_edges=np.arange(width + 1.0),
        y_edges=np.arange(height + 1.0),
        rows=rows[..., np.newaxis],
        locate=locate,
        labels=("column", "row"),
        decorate=decorate,
        is_map=True,
        has_numbers=max(height, width) <= 12,
        size=(max(3.5, 1.4 + side), max(2.4, 1.2 + side * height / width)),
    )


def _draw_letters(ax: "Axes", letters: NDArray[np.str_], ink: str) -> None:
    from matplotlib.patches import Rectangle

    size = max(7.0, min(11.0, 110 / max(letters.shape)))
    style: dict[str, Any] = {"color": ink, "fontsize": size, "zorder": 7, "path_effects": outline(ink)}
    for (row, column), letter in np.ndenumerate(letters):
        if letter == "#":
            ax.add_patch(Rectangle((column, row), 1, 1, facecolor=ink, alpha=0.75, linewidth=0))
        elif letter == "S":
            ax.text(column + 0.08, row + 0.08, "S", ha="left", va="top", fontweight="bold", **style)
        elif letter in NAMES:
            ax.add_patch(Rectangle((column, row), 1, 1, facecolor=FILLS[letter], alpha=0.35, linewidth=0, zorder=1))
            ax.text(column + 0.5, row + 0.5, NAMES[letter], ha="center", va="center", **style)
