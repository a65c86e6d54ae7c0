"""A grid of cells around the multiples of a step: ``round((observation - low) * scale)``, as in the article."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._spec import RoundSpec
from qtab._utils.shown import counted, shown
from qtab.config import Config
from qtab.discretizers.base import check_table_size
from qtab.discretizers.box import BoxDiscretizer, box_of, check_stored_bounds, example_of_limits


@dataclass(frozen=True, eq=False, repr=False)
class Rounding(BoxDiscretizer):
    """Rounds each component of the observation to the nearest cell. Observations outside the space raise an error."""

    scale: NDArray[np.float64]
    """(d,): the number of cells per unit of each component."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "Rounding":
        """Returns the grid over an observation space with finite bounds.

        Raises:
            ValueError: if the space or the scale does not fit, or the table would be too large.
        """
        box, scale = box_of(space), config.scale
        if not (np.isfinite(box.low).all() and np.isfinite(box.high).all()):
            raise ValueError(
                f"the observation space must have finite bounds for discretizer 'round', got "
                f"{' '.join(str(box).split())}; discretizer 'bins' and 'tiles' take low= and high="
                + example_of_limits(box, "discretizer='bins', bins=6, ")
            )
        if not (box.low <= box.high).all():
            raise ValueError(f"the observation space must have low <= high, got {box}")
        if len(scale) != len(box.low):
            numbers = counted(len(box.low), "number")
            held = f"hold {numbers} for this observation space, the cells per unit of each component"
            if not scale:
                raise ValueError(f"scale must be given and {held}, or discretizer='bins' or 'tiles' without it")
            raise ValueError(
                f"scale must {held}, got {shown(scale)}; without a scale, choose discretizer 'bins' or 'tiles'"
            )
        grid = cls(box.low, box.high, np.array(scale, dtype=np.float64))
        with np.errstate(over="ignore"):
            cells = (box.high - box.low).astype(np.float64) * grid.scale
            check_table_size("scale", scale, float(np.prod(cells + 1)) * n_actions)
        return grid

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "Rounding":  # noqa: ARG003
        """Returns the grid of a saved run; see :meth:`Discretizer.restore`."""
        grid = cls(arrays["low"], arrays["high"], arrays["scale"])
        check_stored_bounds(grid.low, grid.high)
        bounds = (grid.low, grid.high, grid.scale)
        if any(bound.shape != (len(config.scale),) or not np.isfinite(bound).all() for bound in bounds):
            raise ValueError("its bounds do not fit its scale")
        if tuple(grid.scale) != config.scale:
            raise ValueError("its scale is not that of its config")
        return grid

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Returns the arrays to save."""
        return {**super().arrays(), "scale": self.scale}

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of cells along each component."""
        cells = np.round((self.high - self.low) * self.scale, 0).astype(int) + 1
        return tuple(int(count) for count in cells)

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the edges halfway between the multiples of a step, and the bounds of the space."""
        return tuple(
            np.clip(low + (np.arange(count + 1) - 0.5) / scale, low, high)
            for low, high, scale, count in zip(
                self.low.astype(np.float64), self.high.astype(np.float64), self.scale, self.shape, strict=True
            )
        )

    def spec(self) -> RoundSpec:
        """Returns the discretizer as the extension takes it."""
        return {
            "type": "round",
            "dtype": self.dtype,
            "low": self.low.tolist(),
            "high": self.high.tolist(),
            "scale": self.scale.tolist(),
        }
