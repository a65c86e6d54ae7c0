"""The quantities that can be axes of a picture."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qtab.plots.subject import Subject
from qtab.results.axes import Axis


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
