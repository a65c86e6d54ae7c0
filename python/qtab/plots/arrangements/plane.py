"""Two components of the observation along the axes of the picture, and the others held fixed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.shown import did_you_mean
from qtab.plots.arrangements.raster import Raster, outline
from qtab.plots.arrangements.ticks import line_height, name_ticks
from qtab.plots.parts.subject import Subject
from qtab.results.axes import Axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class Coordinate:
    """A quantity that can be an axis: a component of the observation, or an angle given by its cosine and sine."""

    name: str
    label: str
    low: float
    high: float
    components: tuple[int, ...]
    """The index of the component, or those of the cosine and the sine."""
    edges: NDArray[np.float64] | None
    """The edges of its cells; None for an angle."""

    @property
    def default(self) -> float:
        """Zero, or the bound nearest to it."""
        return float(np.clip(0.0, self.low, self.high))

    def read(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the quantity of observations, (n, d), as (n,)."""
        if len(self.components) == 2:
            cosine, sine = self.components
            return np.arctan2(points[:, sine], points[:, cosine])
        return points[:, self.components[0]]


def coordinates(subject: Subject) -> tuple[Coordinate, ...]:
    """Returns the quantities that can be axes: angles first, then the remaining components in order."""
    axes = subject.axes
    quantities = subject.quantities
    named = tuple(axis.name for axis in axes) == tuple(one.name for one in quantities.observation)
    angles = quantities.angles if named else ()
    used = {index for angle in angles for index in (angle.cosine, angle.sine)}
    turns = [
        Coordinate(angle.quantity.name, angle.quantity.label, -np.pi, np.pi, (angle.cosine, angle.sine), None)
        for angle in angles
    ]
    return (*turns, *(_component(index, axis) for index, axis in enumerate(axes) if index not in used))


def _component(index: int, axis: Axis) -> Coordinate:
    """Returns the coordinate of a component; outer bins without an outer edge are as wide as their neighbors."""
    edges = axis.edges.copy()
    inner = edges[np.isfinite(edges)]
    width = float(np.diff(inner).mean()) if len(inner) > 1 else 1.0
    for end, step in ((0, -width), (-1, width)):
        if not np.isfinite(edges[end]):
            nearest = inner[end] if len(inner) else step / 2 + 0.0
            edges[end] = nearest + step
    return Coordinate(axis.name, axis.label, float(edges[0]), float(edges[-1]), (index,), edges)


RESOLUTION = 200
"""The number of points along each axis, if cells cannot be drawn as they are."""


def plane(subject: Subject, at: Mapping[str, float] | None, sampled: bool = False) -> Raster:
    """Returns the raster of two coordinates.

    Args:
        subject: The subject to draw.
        at: The coordinates that are held fixed, by name; None and missing ones take their defaults.
        sampled: Whether to sample points even if cells could be drawn as they are.

    Raises:
        TypeError: if ``at`` is not a mapping of names to numbers.
        ValueError: for an unknown name, a number out of range, or fewer than two free coordinates.
    """
    known = coordinates(subject)
    chosen, fixed = _choose(subject, known, at)
    discretizer = subject.discretizer
    as_cells = discretizer.has_cells and not sampled and all(one.edges is not None for one in known)
    edges = [
        one.edges if as_cells and one.edges is not None else np.linspace(one.low, one.high, RESOLUTION + 1)
        for one in chosen
    ]
    if len(edges) == 1:
        edges.append(np.array([0.0, 1.0]))
    shape = (len(edges[1]) - 1, len(edges[0]) - 1)
    observations = _observations(subject, known, chosen, fixed, edges)
    if as_cells:
        rows = _cell_rows(subject, known, chosen, fixed)
    else:
        rows = discretizer.active_features(observations)
    note = ", ".join(f"{one.name} = {fixed[one.name]:.4g}" for one in known if one.name in fixed)

    def locate(observed: NDArray[Any]) -> NDArray[np.float64]:
        points = np.asarray(observed, np.float64)
        points = points[:, np.newaxis] if points.ndim == 1 else points
        columns = [one.read(points) for one in chosen]
        return np.stack(columns if len(columns) == 2 else [*columns, np.full(len(points), 0.5)], axis=-1)

    return Raster(
        x_edges=edges[0],
        y_edges=edges[1],
        rows=rows.reshape(*shape, -1),
        locate=locate,
        labels=(chosen[0].label, chosen[1].label if len(chosen) > 1 else ""),
        note=note,
        decorate=lambda ax, ink: _decorate(ax, ink, subject, chosen),
        has_numbers=len(chosen) == 1 and shape[1] <= 20,
        observations=observations,
        size=(6.4, 4.5) if len(chosen) > 1 else (8.0, line_height(subject.axes[0].values)),
    )


def _decorate(ax: "Axes", ink: str, subject: Subject, chosen: list[Coordinate]) -> None:
    """Draws the marks of the environment, such as a goal, and the ticks of named values and of angles."""
    for mark in subject.quantities.marks:
        for line, one in zip((ax.axvline, ax.axhline), chosen, strict=False):
            if one.name == mark.name:
                line(mark.value, color=ink, linewidth=1, linestyle=(0, (4, 3)), zorder=3)
                # Inside the axes, at the left of the line.
                style: dict[str, Any] = {"color": ink, "fontsize": "small", "path_effects": outline(ink), "zorder": 6}
                ends: Any = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
                ax.annotate(mark.text, (mark.value, 0.02), (-3, 0), ha="right", va="bottom", **ends, **style)
    for axis, one in zip((ax.xaxis, ax.yaxis), chosen, strict=False):
        values = next((known.values for known in subject.axes if known.name == one.name), ())
        if values and len(values) <= round(one.high - one.low):
            if axis is ax.xaxis:
                name_ticks(ax, values, one.low + 0.5)
            else:
                axis.set_ticks(one.low + 0.5 + np.arange(len(values)), values)
        if one.edges is None:
            axis.set_ticks([-np.pi, -np.pi / 2, 0, np.pi / 2, np.pi], ["-π", "-π/2", "0", "π/2", "π"])
    if len(chosen) == 1:
        ax.set_yticks([])


def _choose(
    subject: Subject, known: tuple[Coordinate, ...], at: Mapping[str, float] | None
) -> tuple[list[Coordinate], dict[str, float]]:
    if at is not None and not isinstance(at, Mapping):
        raise TypeError(f"at must be a mapping of the names of components to numbers, got {at!r}")
    by_name = {one.name: one for one in known}
    fixed = {}
    for name, value in (at or {}).items():
        if name not in by_name:
            listed = ", ".join(map(repr, by_name))
            raise ValueError(
                f"at must name components of the observation ({listed}), got {name!r}{did_you_mean(str(name), by_name)}"
            )
        one = by_name[name]
        fixed[name] = checks.real(f"at[{name!r}]", value, one.low, one.high)
    free = [one for one in known if one.name not in fixed]
    if len(free) < min(2, len(known)):
        raise ValueError(
            f"at must leave two components as the axes of the picture, got values for {', '.join(map(repr, fixed))}"
        )
    preferred = [one for one in free if one.name in subject.quantities.plane]
    chosen = preferred if len(preferred) == 2 and len(free) > 2 else free[:2]
    return chosen, fixed | {one.name: one.default for one in free if one not in chosen}


def _observations(
    subject: Subject,
    known: tuple[Coordinate, ...],
    chosen: list[Coordinate],
    fixed: Mapping[str, float],
    edges: list[NDArray[np.float64]],
) -> NDArray[Any]:
    """Returns the observation in the middle of each point of the picture."""
    middles = [(ends[1:] + ends[:-1]) / 2 for ends in edges]
    grid = np.meshgrid(*middles)
    found = np.empty((grid[0].size, len(subject.axes)))
    for one in known:
        value = grid[chosen.index(one)].ravel() if one in chosen else np.full(grid[0].size, fixed[one.name])
        if len(one.components) == 2:
            found[:, one.components[0]], found[:, one.components[1]] = np.cos(value), np.sin(value)
        else:
            found[:, one.components[0]] = value
    low = subject.discretizer.low
    return np.round(found).astype(np.int64) if low.dtype == np.int64 else found.astype(low.dtype)


def _cell_rows(
    subject: Subject, known: tuple[Coordinate, ...], chosen: list[Coordinate], fixed: Mapping[str, float]
) -> NDArray[np.int64]:
    shape = subject.discretizer.shape
    axes = [np.arange(shape[one.components[0]]) for one in chosen]
    grid = np.meshgrid(*axes) if len(axes) == 2 else [axes[0][np.newaxis]]
    index: list[Any] = [0] * len(shape)
    for one in known:
        component = one.components[0]
        if one in chosen:
            index[component] = grid[chosen.index(one)]
        elif one.edges is not None:
            index[component] = int(np.searchsorted(one.edges[1:-1], fixed[one.name], side="right"))
    return np.ravel_multi_index(np.broadcast_arrays(*index), shape)[..., np.newaxis]
