"""The parts shared by all weighted features of Box observations."""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from typing_extensions import Self

from qtab._spec import BoxSpec
from qtab._utils import html
from qtab._utils.checks import required
from qtab.config import Config
from qtab.discretizers.base import MAX_SHOWN
from qtab.discretizers.box import BoxDiscretizer, Span, check_stored_bounds, span, too_far_apart
from qtab.envs.actions import FLOATS


@dataclass(frozen=True, eq=False, repr=False)
class WeightedFeatures(BoxDiscretizer):
    """Features x(s) of observations that are scaled to [0, 1], each with a row of the table.

    The value of an action is the sum of the products of its weights and these features.
    """

    has_cells: ClassVar[bool] = False
    is_weighted: ClassVar[bool] = True

    span: Span
    """The limits that are scaled to 0 and 1. Observations are clipped to them."""

    @classmethod
    @abstractmethod
    def options(cls, config: Config, dimensions: int) -> dict[str, Any]:
        """Returns the other fields: the options of a config for so many components.

        Raises:
            ValueError: if an option does not fit the number of components.
        """

    @abstractmethod
    def check_options(self) -> None:
        """Raises an error for options that do not fit together.

        Raises:
            ValueError: for such options, or more features than possible.
        """

    @property
    @abstractmethod
    def description(self) -> str:
        """The options that determine the number of features, such as "of order 3"."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> Self:  # noqa: ARG003
        """Returns the features over the limits of a config, or else over the bounds of the space.

        Raises:
            ValueError: if the space or an option does not fit, or there would be too many features.
        """
        if not isinstance(space, spaces.Box) or len(space.shape) != 1 or space.dtype not in FLOATS:
            is_flat = isinstance(space, spaces.Box) and len(space.shape) == 1
            wrapped = "env" if is_flat else "FlattenObservation(env)"
            wrapper = wrapped if _has_floats(space) else f"DtypeObservation({wrapped}, np.float32)"
            raise ValueError(
                "discretizer must be another one for an observation space that is not a Box of float32 or float64 with "
                f"one axis, {' '.join(str(space).split())}, got {config.discretizer!r}; {wrapper} of "
                "gymnasium.wrappers makes one"
            )
        limits = span(space, config.low, config.high)
        built = cls(space.low, space.high, limits, **cls.options(config, len(space.low)))
        built.check_options()
        with np.errstate(over="ignore"):
            if not np.isfinite(limits[1] - limits[0]).all():
                raise too_far_apart(limits, np.dtype(np.float64))
        return built

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> Self:
        """Returns the features of a saved run; see :meth:`Discretizer.restore`."""
        low, high = arrays["low"], arrays["high"]
        check_stored_bounds(low, high)
        limits = np.array(required("low", config.low)), np.array(required("high", config.high))
        if {bound.shape for bound in (high, *limits)} != {low.shape} or low.ndim != 1:
            raise ValueError("its bounds do not fit each other")
        restored = cls(low, high, limits, **cls.options(config, len(low)))
        if restored.n_rows != n_rows:
            raise ValueError("its table has another number of rows than its features")
        restored.check_options()
        return restored

    def __repr__(self) -> str:
        """Returns one line: the number of features, and the options that determine it."""
        return f"<{type(self).__name__}: {self.n_rows:,} features {self.description}>"

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
        raise ValueError(
            f"every row of {type(self).__name__} is active for every observation; use feature_values(observation)"
        )

    def box_spec(self) -> BoxSpec:
        """Returns the part of :meth:`spec` that all weighted features have."""
        low, high = self.span
        return {"dtype": self.dtype, "low": low.tolist(), "high": high.tolist()}


def _has_floats(space: Any) -> bool:
    """Returns whether the observations of a space hold numbers of float32 or float64, also once they are flattened."""
    if isinstance(space, spaces.Dict | spaces.Tuple):
        return any(map(_has_floats, space.spaces.values() if isinstance(space, spaces.Dict) else space.spaces))
    return isinstance(space, spaces.Box) and space.dtype in FLOATS
