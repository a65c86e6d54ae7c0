"""Bins of equal width, as ``gymnasium.wrappers.DiscretizeObservation`` computes them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config import Config
from qtab.discretizers.base import check_table_size
from qtab.discretizers.box import Span, box_of, per_dimension, span, too_far_apart
from qtab.discretizers.edges import Edges


@dataclass(frozen=True, eq=False, repr=False)
class Bins(Edges):
    """A grid of bins of equal width. Values outside the span belong to the outermost bins."""

    span: Span
    """The limits that the bins cover."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "Bins":
        """Returns the bins over the limits of a config, or else over the bounds of the space.

        Raises:
            ValueError: if the space or an option does not fit, or the table would be too large.
        """
        box = box_of(space)
        low, high = span(box, config.low, config.high)
        counts = per_dimension("bins", required("bins", config.bins), len(box.low))
        check_table_size("bins", counts, math.prod(map(float, counts)) * n_actions)
        bins = cls(box.low, box.high, _edges(box.low.dtype, (low, high), counts), (low, high))
        if not all(np.isfinite(edges).all() for edges in bins.edges):
            raise too_far_apart((low, high), box.low.dtype)
        return bins

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "Bins":
        """Returns the bins of a saved run; see :meth:`Discretizer.restore`."""
        counts = required("bins", config.bins)
        if math.prod(counts) != n_rows:
            raise ValueError("its table has another number of rows than its bins")
        limits = np.array(required("low", config.low)), np.array(required("high", config.high))
        low, high = arrays["low"], arrays["high"]
        bins = cls(low, high, _edges(low.dtype, limits, counts), limits)
        bins.check_stored()
        return bins

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the edges between the bins, and their outer limits."""
        return self._with_outermost(*self.span)

    def settings(self) -> dict[str, Any]:
        """Returns the number of bins of each component, and the limits."""
        low, high = self.span
        return {"bins": self.shape, "low": tuple(low.tolist()), "high": tuple(high.tolist())}


def _edges(dtype: "np.dtype[Any]", span: Span, counts: tuple[int, ...]) -> tuple[NDArray[np.floating], ...]:
    """Returns the inner edges, computed in the dtype of the space."""
    with np.errstate(over="ignore", invalid="ignore"):
        low, high = (limit.astype(dtype) for limit in span)
        return tuple(
            np.linspace(first, last, count + 1)[1:-1] for first, last, count in zip(low, high, counts, strict=True)
        )
