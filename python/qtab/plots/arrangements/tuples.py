"""States with named or numbered components, such as ``(3, 0)`` or ``{'row': 3, 'column': 0}``: a map of two of them."""

import ast
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.plots.arrangements.raster import Raster
from qtab.plots.arrangements.ticks import name_ticks, thinned

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_MAPS = 24
"""The most combinations of the components that are no axes: each has a map of its own."""
MOST_EMPTY = 6.0
"""The largest number of cells, in numbers of states."""
ROWS, COLUMNS = ("row", "r", "y"), ("column", "col", "c", "x")
"""The names of components that are the axes of the map."""
MOST_TICKS = 20
MOST_IN_LINE = 20
MOST_NUMBERS = 12
"""A number fits into a cell of a map of up to this many rows and columns."""


@dataclass(frozen=True)
class Component:
    """A component of the states that has several values."""

    name: str
    values: tuple[Any, ...]
    """Its values in order."""
    of_states: NDArray[np.int64]
    """(states,): the index of the value in each state."""

    def __len__(self) -> int:
        return len(self.values)

    @property
    def ticks(self) -> list[str]:
        """Returns the values as text."""
        return [str(value) for value in self.values]


class _Set(tuple[Any, ...]):
    """The elements of a set in order, because sets are not ordered among each other."""

    __slots__ = ()

    def __str__(self) -> str:
        return f"{{{', '.join(map(repr, self))}}}"


def components(names: Sequence[str]) -> tuple[Component, ...]:
    """Returns the components of states that have more than one value; none if the names cannot be read.

    Args:
        names: The name of each state, as Python writes tuples, lists, dicts, named tuples and dataclasses.
    """
    try:
        read = [dict(_parts(ast.parse(name, mode="eval").body, "")) for name in names]
    except (SyntaxError, ValueError, TypeError, RecursionError, MemoryError):  # the last two of deeply nested names
        return ()
    if not read or any(state.keys() != read[0].keys() for state in read):
        return ()
    found = []
    for part in read[0]:
        of_states = [state[part] for state in read]
        values = _in_order(set(of_states))
        if len(values) > 1:
            index = {value: number for number, value in enumerate(values)}
            found.append(Component(part or "state", values, np.array([index[value] for value in of_states])))
    return tuple(found)


def _parts(node: Any, name: str) -> list[tuple[str, Any]]:
    """Returns the numbers and texts of an expression by their names, such as ``"state[0]"``."""
    if isinstance(node, ast.Tuple | ast.List):
        inner = [(f"{name or 'state'}[{index}]", part) for index, part in enumerate(node.elts)]
    elif isinstance(node, ast.Dict):
        keys = [ast.literal_eval(key) for key in node.keys if key is not None]
        inner = [(f"{name}.{key}" if name else str(key), part) for key, part in zip(keys, node.values, strict=True)]
    elif isinstance(node, ast.Call) and not node.args and _elements(node) is None:
        inner = [(f"{name}.{one.arg}" if name else str(one.arg), one.value) for one in node.keywords]
    else:
        elements = _elements(node)
        return [(name, ast.literal_eval(node) if elements is None else _Set(_in_order(set(elements))))]
    return [found for label, part in inner for found in _parts(part, label)]


def _elements(node: Any) -> list[Any] | None:
    """Returns the elements of a set or frozenset; None if the expression is none."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("set", "frozenset"):
        if not node.args and not node.keywords:
            return []
        node = node.args[0] if len(node.args) == 1 and not node.keywords else node
    return [ast.literal_eval(element) for element in node.elts] if isinstance(node, ast.Set) else None


def _in_order(values: set[Any]) -> tuple[Any, ...]:
    try:
        return tuple(sorted(values))
    except TypeError:  # of different types
        return tuple(sorted(values, key=str))


def tuples(names: Sequence[str]) -> Raster | None:
    """Returns the raster of states with several components: a map of two of them, one for each value of the others.

    States with a single component are in a line, in the order of its values.

    Components named as rows and columns are the axes, else the two with the most values. The first of these runs
    downwards, as the rows of an array; if it has far more values than the second, it runs to the right.

    Args:
        names: The name of each state.

    Returns:
        The raster; None if the names cannot be read, or if most cells of the maps would be empty.
    """
    known = components(names)
    if len(known) == 1:
        return _line(known[0])
    if not known:
        return None
    down, right = _axes(known)
    others = [one for one in known if one not in (down, right)]
    shown = sorted(set(zip(*(one.of_states.tolist() for one in others), strict=True))) if others else [()]
    columns = 1 if len(shown) == 1 else math.ceil(math.sqrt(len(shown) * (len(down) + 1) / (len(right) + 1)))
    columns = min(columns, len(shown))
    above = int(len(shown) > 1)  # a line for the title of a map
    pitch = len(down) + 1 + above
    height, width = pitch * -(-len(shown) // columns) - 1, (len(right) + 1) * columns - 1
    if len(shown) > MOST_MAPS or len(down) * len(right) * len(shown) > MOST_EMPTY * len(names):
        return None
    number = {values: index for index, values in enumerate(shown)}
    maps = np.array([number[tuple(int(one.of_states[state]) for one in others)] for state in range(len(names))])
    ys = maps // columns * pitch + above + down.of_states
    xs = maps % columns * (len(right) + 1) + right.of_states
    rows = np.full((height, width), -1)
    rows[ys, xs] = np.arange(len(names))
    if (rows >= 0).sum() < len(names):  # states with the same name
        return None
    titles = [
        ", ".join(f"{one.name} = {one.values[index]}" for one, index in zip(others, at, strict=True)) for at in shown
    ]
    corners = [(at % columns * (len(right) + 1), at // columns * pitch + above) for at in range(len(shown))]
    largest = max(height, width)
    side = 8 * min(1.0, width / max(height, 8))
    return Raster(
        x_edges=np.arange(width + 1.0),
        y_edges=np.arange(height + 1.0),
        rows=rows[..., np.newaxis],
        locate=lambda observed: np.stack([xs, ys], axis=-1)[np.asarray(observed).ravel()] + 0.5,
        labels=(right.name, down.name),
        decorate=lambda ax, ink: _decorate(ax, ink, down, right, corners, titles),
        is_map=True,
        has_moves=down.name == "row" and right.name in ("column", "col"),
        has_gaps=len(shown) > 1,
        has_numbers=largest <= MOST_NUMBERS,
        size=(max(3.5, 1.4 + side), max(2.4, 1.2 + side * height / width)),
    )


def _line(one: Component) -> Raster | None:
    """Returns the raster of states that differ in one component; None if some have the same value."""
    if len(one) < len(one.of_states):
        return None
    count = len(one)

    def decorate(ax: "Axes", ink: str) -> None:  # noqa: ARG001 - as of every arrangement
        name_ticks(ax, one.ticks)
        ax.set_yticks([])

    return Raster(
        x_edges=np.arange(count + 1.0),
        y_edges=np.array([0.0, 1.0]),
        rows=np.argsort(one.of_states)[np.newaxis, :, np.newaxis],
        locate=lambda observed: np.stack(
            [one.of_states[np.ravel(observed)] + 0.5, np.full(np.size(observed), 0.5)], -1
        ),
        labels=(one.name, ""),
        decorate=decorate,
        has_numbers=count <= MOST_IN_LINE,
        size=(8.0, 2.0),
    )


def _axes(known: Sequence[Component]) -> tuple[Component, Component]:
    """Returns the components that run downwards and to the right."""
    by_name: Mapping[str, Component] = {one.name: one for one in known}
    row = next((by_name[name] for name in ROWS if name in by_name), None)
    column = next((by_name[name] for name in COLUMNS if name in by_name), None)
    if row is not None and column is not None:
        return row, column
    largest = sorted(known, key=len, reverse=True)[:2]
    first, second = (one for one in known if one in largest)
    return (second, first) if len(first) > 2 * len(second) else (first, second)


def _decorate(
    ax: "Axes",
    ink: str,
    down: Component,
    right: Component,
    corners: Sequence[tuple[int, int]],
    titles: Sequence[str],
) -> None:
    """Draws the lines of each map, its title above, and the ticks of the values."""
    line: dict[str, Any] = {"colors": ink, "linewidth": 0.6, "alpha": 0.5, "zorder": 5}
    for (x, y), title in zip(corners, titles, strict=True):
        ax.hlines(y + np.arange(len(down) + 1), x, x + len(right), **line)
        ax.vlines(x + np.arange(len(right) + 1), y, y + len(down), **line)
        if len(corners) > 1:
            ax.text(x, y - 0.1, title, ha="left", va="bottom", fontsize="x-small", color=ink)
    most = max(2, MOST_TICKS // len({x for x, _ in corners}))
    for axis, one, starts in (
        (ax.xaxis, right, sorted({x for x, _ in corners})),
        (ax.yaxis, down, sorted({y for _, y in corners})),
    ):
        kept = thinned(len(one), most if one is right else max(2, MOST_TICKS // len(starts)))
        places = [start + index + 0.5 for start in starts for index in kept]
        axis.set_ticks(places, [one.ticks[index] for _ in starts for index in kept])
    ax.tick_params(labelsize="small")
