"""The Fourier basis (Konidaris, Osentoski & Thomas, 2011; Sutton & Barto, 2nd ed., section 9.5.2)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._spec import FourierSpec
from qtab._utils import html
from qtab._utils.checks import required
from qtab.config import Config
from qtab.discretizers.base import MAX_SHOWN
from qtab.discretizers.box import BoxDiscretizer, Span, check_stored_bounds, span
from qtab.envs.actions import FLOATS

MAX_FEATURES = 1024
"""The maximum number of features: a step takes time in proportion to it."""


@dataclass(frozen=True, eq=False, repr=False)
class FourierBasis(BoxDiscretizer):
    """The features x(s) = cos(π c·s) of observations that are scaled to [0, 1], each with a row of the table.

    The value of an action is the sum of the products of its weights and these features.
    """

    has_cells: ClassVar[bool] = False
    is_weighted: ClassVar[bool] = True

    span: Span
    """The limits that are scaled to 0 and 1. Observations are clipped to them."""
    order: int
    """The largest frequency of a component."""
    coupled: bool
    """Whether there is a feature for each combination of frequencies, not only for those of single components."""
    scale_step_sizes: bool
    """Whether the learning rate of a feature is divided by the length of its frequency vector c."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "FourierBasis":  # noqa: ARG003
        """Returns the basis over the limits of a config, or else over the bounds of the space.

        Raises:
            ValueError: if the space or an option does not fit, or there would be too many features.
        """
        if not isinstance(space, spaces.Box) or len(space.shape) != 1 or space.dtype not in FLOATS:
            is_flat = isinstance(space, spaces.Box) and len(space.shape) == 1
            wrapper = "DtypeObservation(env, np.float32)" if is_flat else "FlattenObservation"
            raise ValueError(
                "discretizer must be another one for an observation space that is not a Box of floats with one axis, "
                f"{' '.join(str(space).split())}, got 'fourier'; gymnasium.wrappers.{wrapper} makes one"
            )
        limits = span(space, config.low, config.high)
        order, coupled = required("order", config.order), required("coupled", config.coupled)
        dimensions = len(space.low)
        count = n_features(dimensions, order, coupled=coupled)
        if count > MAX_FEATURES:
            fewer = n_features(dimensions, order, coupled=False)
            instead = f"; coupled=False gives {fewer:,}" if coupled and fewer <= MAX_FEATURES else ""
            given = f"{count:,}" if count < 10**9 else "more than a billion"
            raise ValueError(
                f"order must give at most {MAX_FEATURES:,} features, got {order} with {dimensions} components, which "
                f"gives {given}{instead}"
            )
        with np.errstate(over="ignore"):
            if not np.isfinite(limits[1] - limits[0]).all():
                raise ValueError(
                    f"high must not lie so far above low, got {limits[0].tolist()} and {limits[1].tolist()}"
                )
        return cls(space.low, space.high, limits, order, coupled, required("scale_step_sizes", config.scale_step_sizes))

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "FourierBasis":
        """Returns the basis of a saved run; see :meth:`Discretizer.restore`."""
        low, high = arrays["low"], arrays["high"]
        check_stored_bounds(low, high)
        limits = np.array(required("low", config.low)), np.array(required("high", config.high))
        if {bound.shape for bound in (high, *limits)} != {low.shape} or low.ndim != 1:
            raise ValueError("its bounds do not fit each other")
        order, coupled = required("order", config.order), required("coupled", config.coupled)
        if n_features(len(low), order, coupled=coupled) != n_rows:
            raise ValueError("its table has another number of rows than its features")
        return cls(low, high, limits, order, coupled, required("scale_step_sizes", config.scale_step_sizes))

    def __repr__(self) -> str:
        """Returns one line: the number of features, and the order."""
        return f"<FourierBasis: {self.n_rows:,} features of order {self.order}>"

    def _repr_html_(self) -> str:
        """Returns a table of the limits of each component, for notebooks."""
        low, high = self.span
        limits = zip(low.tolist(), high.tolist(), strict=True)
        rows = [(index, f"{first:.6g}", f"{last:.6g}") for index, (first, last) in enumerate(limits)]
        return html.listing(repr(self)[1:-1], ("component", "from", "to"), rows[:MAX_SHOWN])

    def settings(self) -> dict[str, Any]:
        """Returns the limits."""
        low, high = self.span
        return {"low": tuple(low.tolist()), "high": tuple(high.tolist())}

    @property
    def shape(self) -> tuple[int]:
        """The number of features."""
        return (n_features(len(self.low), self.order, coupled=self.coupled),)

    @property
    def n_active(self) -> int:
        """The number of features: all are active."""
        return self.n_rows

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the limits of each component."""
        return tuple(np.array(limits) for limits in zip(*self.span, strict=True))

    def feature_values(self, observation: Any) -> NDArray[np.float64]:
        """Returns the (n_rows,) features of an observation, or the (n, n_rows) features of n observations.

        Raises:
            TypeError: if the observation does not hold numbers.
            ValueError: if the observation does not have the shape of the space, or is not a number.
        """
        return self._compiled.feature_values(observation)

    def active_features(self, observation: Any) -> NDArray[Any]:
        """Returns :meth:`feature_values`."""
        return self.feature_values(observation)

    def active_rows(self, observation: Any) -> NDArray[np.int64]:  # noqa: ARG002
        """Raises an error: rows alone do not determine the value of an observation.

        Raises:
            ValueError: always.
        """
        raise ValueError("FourierBasis has no rows of its own for an observation; feature_values(observation) works")

    def spec(self) -> FourierSpec:
        """Returns the basis as the extension takes it."""
        low, high = self.span
        return {
            "type": "fourier",
            "dtype": self.dtype,
            "low": low.tolist(),
            "high": high.tolist(),
            "order": self.order,
            "coupled": self.coupled,
            "scale_step_sizes": self.scale_step_sizes,
        }


def n_features(dimensions: int, order: int, *, coupled: bool) -> int:
    """Returns the number of features over so many components."""
    return (order + 1) ** dimensions if coupled else dimensions * order + 1
