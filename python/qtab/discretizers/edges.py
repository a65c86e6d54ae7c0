"""Bins between the user's own edges: ``numpy.digitize`` along each component."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._spec import BinsSpec
from qtab._utils.checks import required
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.discretizers.base import check_table_size
from qtab.discretizers.box import BoxDiscretizer, box_of, check_stored_bounds


@dataclass(frozen=True, eq=False, repr=False)
class Edges(BoxDiscretizer):
    """A grid of bins. An edge belongs to the bin above it; the outermost bins are unbounded."""

    edges: tuple[NDArray[np.floating], ...]
    """The ascending edges between the bins of each component, one fewer than there are bins."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "Edges":
        """Returns the bins between the edges of a config.

        Raises:
            ValueError: if the space or the edges do not fit, or the table would be too large.
        """
        box, edges = box_of(space), config.edges
        if edges is None or len(edges) != len(box.low):
            raise ValueError(
                f"edges must hold {len(box.low)} rows of numbers for this observation space, got {shown(edges)}"
            )
        check_table_size("edges", edges, math.prod(len(row) + 1.0 for row in edges) * n_actions)
        return cls(box.low, box.high, _arrays(edges))

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "Edges":  # noqa: ARG003
        """Returns the bins of a saved run; see :meth:`Discretizer.restore`."""
        bins = cls(arrays["low"], arrays["high"], _arrays(required("edges", config.edges)))
        bins.check_stored()
        return bins

    def check_stored(self) -> None:
        """Checks that bounds from a file fit the edges.

        Raises:
            ValueError: if dtypes or shapes differ, or an edge is not finite.
        """
        check_stored_bounds(self.low, self.high)
        finite = all(np.isfinite(edges).all() for edges in self.edges)
        if not finite or {self.low.shape, self.high.shape} != {(len(self.edges),)}:
            raise ValueError("its bounds do not fit its bins")

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of bins along each component."""
        return tuple(len(edges) + 1 for edges in self.edges)

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the edges between the bins, and the bounds of the space, which can be infinite."""
        return self._with_outermost(self.low, self.high)

    def _with_outermost(self, low: NDArray[Any], high: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        return tuple(
            np.array([min([first, *edges]), *edges, max([last, *edges])], dtype=np.float64)
            for first, last, edges in zip(low.tolist(), high.tolist(), self.edges, strict=True)
        )

    def spec(self) -> BinsSpec:
        """Returns the discretizer as the extension takes it."""
        edges = [edges.astype(np.float64).tolist() for edges in self.edges]
        return {"type": "bins", "dtype": self.dtype, "edges": edges}


def _arrays(edges: tuple[tuple[float, ...], ...]) -> tuple[NDArray[np.float64], ...]:
    return tuple(np.array(row, dtype=np.float64) for row in edges)
