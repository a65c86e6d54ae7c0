"""Tile coding (Sutton & Barto, 2nd ed., section 9.5.4)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from qtab._spec import TilesSpec
from qtab._utils.checks import required
from qtab.config import Config
from qtab.discretizers.base import check_table_size
from qtab.discretizers.box import BoxDiscretizer, Span, box_of, check_stored_bounds, per_dimension, span, too_far_apart

MAX_OFFSETS = 2**32 - 1
"""The limit of tiles times tilings along a component: positions are counted in parts of a tile, one per tiling."""


@dataclass(frozen=True, eq=False, repr=False)
class TileCoding(BoxDiscretizer):
    """Several tilings of a box, each shifted by a different fraction of a tile. One row of each tiling is active."""

    has_cells: ClassVar[bool] = False

    span: Span
    """The limits that the tilings cover. Observations are clipped to them."""
    tiles: tuple[int, ...]
    """The number of tiles along each component."""
    tilings: int
    hashed_rows: int | None
    """The number of rows that the tilings share; None gives each tile its own row."""

    def __post_init__(self) -> None:
        """Checks that tiles can be distinguished and numbered.

        Raises:
            ValueError: if a tile is too narrow or too wide for floats, or 32 bits cannot count the parts of the tiles.
        """
        if max(self.tiles) * self.tilings >= MAX_OFFSETS:
            raise ValueError(
                "tiles times tilings must be less than 2**32 - 1 along each component, got "
                f"tiles={self.tiles} and tilings={self.tilings}"
            )
        low, high = self.span
        with np.errstate(over="ignore", divide="ignore"):
            extent = high - low
            tiles_per_unit = np.array(self.tiles) / extent
        if not np.isfinite(extent).all():
            raise too_far_apart(self.span, np.dtype(np.float64))
        if not np.isfinite(tiles_per_unit).all():
            raise ValueError(f"high must not be so close to low, got low={low.tolist()} and high={high.tolist()}")

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "TileCoding":
        """Returns the tilings over the limits of a config, or else over the bounds of the space.

        Raises:
            ValueError: if the space or an option does not fit, or the table would be too large.
        """
        box = box_of(space)
        limits = span(box, config.low, config.high)
        tiles = per_dimension("tiles", required("tiles", config.tiles), len(box.low))
        tilings, hashed_rows = required("tilings", config.tilings), config.hashed_rows
        if hashed_rows is not None:
            check_table_size("hashed_rows", hashed_rows, float(hashed_rows) * n_actions)
        else:
            values = tilings * math.prod(count + 1.0 for count in tiles) * n_actions
            check_table_size("tiles", tiles, values, ", or hashed_rows= of your choice")
        return cls(box.low, box.high, limits, tiles, tilings, hashed_rows)

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "TileCoding":  # noqa: ARG003
        """Returns the tilings of a saved run; see :meth:`Discretizer.restore`."""
        low, high = arrays["low"], arrays["high"]
        check_stored_bounds(low, high)
        limits = np.array(required("low", config.low)), np.array(required("high", config.high))
        tiles = required("tiles", config.tiles)
        if {bound.shape for bound in (low, high, *limits)} != {(len(tiles),)}:
            raise ValueError("its bounds do not fit its tiles")
        return cls(low, high, limits, tiles, required("tilings", config.tilings), config.hashed_rows)

    def settings(self) -> dict[str, Any]:
        """Returns the number of tiles of each component, and the limits."""
        low, high = self.span
        return {"tiles": self.tiles, "low": tuple(low.tolist()), "high": tuple(high.tolist())}

    @property
    def shape(self) -> tuple[int]:
        """The number of rows: the shifts add one tile along each component."""
        return (self.hashed_rows or self.tilings * math.prod(count + 1 for count in self.tiles),)

    @property
    def n_active(self) -> int:
        """The number of tilings."""
        return self.tilings

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the edges of the tiles of an unshifted tiling."""
        low, high = self.span
        return tuple(np.linspace(*limits) for limits in zip(low, high, np.array(self.tiles) + 1, strict=True))

    def spec(self) -> TilesSpec:
        """Returns the discretizer as the extension takes it."""
        low, high = self.span
        return {
            "type": "tiles",
            "dtype": self.dtype,
            "low": low.tolist(),
            "high": high.tolist(),
            "tiles": self.tiles,
            "tilings": self.tilings,
            "hashed_rows": self.hashed_rows,
        }
