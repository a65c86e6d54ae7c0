"""The parts shared by the discretizers of Box observations."""

from collections.abc import Sequence
from typing import Any, Literal, TypeVar

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._utils.shown import counted, shown
from qtab.discretizers.base import Discretizer
from qtab.envs.actions import FLOATS

Span = tuple[NDArray[np.float64], NDArray[np.float64]]
"""The lower and the upper limits of the components, two arrays of (d,)."""
N = TypeVar("N", int, float)
UNBOUNDED = 3.0
"""The limit of a component without bounds in an example."""
MOST_SHOWN = 8
"""The largest number of components of an example."""


class BoxDiscretizer(Discretizer):
    """A discretizer of the observations of a Box with one axis."""

    @property
    def dtype(self) -> Literal["float32", "float64"]:
        """The dtype of the observations, in which their rows are computed."""
        return "float32" if self.low.dtype == np.float32 else "float64"


def box_of(space: Any) -> spaces.Box:
    """Returns the observation space, a Box with one axis of floats.

    Raises:
        ValueError: if the space is discrete, so that observations index the table directly.
    """
    if not isinstance(space, spaces.Box) or len(space.shape) != 1 or space.dtype not in FLOATS:
        raise ValueError(
            f"the observation space must be a Box for the discretizers of Boxes, got {space}; discretizer must be left "
            "out for it"
        )
    return space


def span(space: spaces.Box, low: Sequence[float] | None, high: Sequence[float] | None) -> Span:
    """Returns the limits that tilings or bins cover: those given for all components, or else the bounds of the space.

    Raises:
        ValueError: if a component has no finite limit, or its lower limit is not below the upper one.
    """
    limits = []
    for name, given, bound in zip(("low", "high"), (low, high), (space.low, space.high), strict=True):
        limit = bound.astype(np.float64) if given is None else np.array(given)
        if limit.shape != bound.shape:
            held = counted(len(bound), "number")
            raise ValueError(f"{name} must hold {held} for this observation space, got {shown(given)}")
        if not np.isfinite(limit).all():
            raise ValueError(
                f"{name} must be given, a number for each component, as the observation space has no finite bounds: "
                f"{' '.join(str(space).split())}{example_of_limits(space)}"
            )
        limits.append(limit)
    if not (limits[0] < limits[1]).all():
        raise ValueError(f"low must lie below high, got {limits[0].tolist()} and {limits[1].tolist()}")
    return limits[0], limits[1]


def too_far_apart(limits: Span, dtype: "np.dtype[Any]") -> ValueError:
    """Returns the error for limits whose difference overflows in the dtype of the computation."""
    low, high = (limit.tolist() for limit in limits)
    return ValueError(f"high - low must be finite in {dtype}, got low={low} and high={high}")


def example_of_limits(space: spaces.Box, more: str = "") -> str:
    """Returns the end of a message, an example of limits: the bounds of a space, and -3 and 3 for infinite ones.

    Args:
        space: The observation space.
        more: Other settings of the example, before the limits.

    Returns:
        ``", such as low=[...], high=[...]"``; empty for a space of many components.
    """
    if len(space.low) > MOST_SHOWN:
        return ""
    low, high = (
        [float(f"{bound:.3g}") if np.isfinite(bound) else instead for bound in bounds.tolist()]
        for bounds, instead in ((space.low, -UNBOUNDED), (space.high, UNBOUNDED))
    )
    return f", such as {more}low={low}, high={high}"


def per_dimension(name: str, given: tuple[N, ...], dimensions: int) -> tuple[N, ...]:
    """Returns a number for each of ``dimensions`` components of the observation, repeating a single number for all.

    Raises:
        ValueError: if there are too few or too many numbers.
    """
    numbers = given * dimensions if len(given) == 1 else given
    if len(numbers) != dimensions:
        held = counted(dimensions, "number") + " for this observation space" + (", or one" if dimensions > 1 else "")
        raise ValueError(f"{name} must hold {held}, got {shown(given)}")
    return numbers


def check_stored_bounds(low: NDArray[Any], high: NDArray[Any]) -> None:
    """Raises an error for bounds from a file that no supported Box has.

    Raises:
        ValueError: if the dtypes of the bounds differ, or are not float32 or float64.
    """
    if low.dtype not in FLOATS or high.dtype != low.dtype:
        raise ValueError("its bounds are not those of a space")
