"""Coarse coding (Sutton & Barto, 2nd ed., section 9.5.3)."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, Literal

from qtab._spec import CoarseSpec
from qtab._utils.shown import counted
from qtab.discretizers.weighted.centers import CenteredFeatures


@dataclass(frozen=True, eq=False, repr=False)
class CoarseCoding(CenteredFeatures):
    """Features that are 1 within their receptive field, a ball around a center of a grid, and 0 outside."""

    extent_name: ClassVar[Literal["radius"]] = "radius"

    radius: tuple[float, ...]
    """The radius of a receptive field along each component, in distances between neighboring centers."""

    def check_options(self) -> None:
        """Raises an error for too many features, and for a radius that is too small or too large.

        Raises:
            ValueError: if there are more than 1,024 features, or observations within no receptive field, or all
                receptive fields contain all observations.
        """
        super().check_options()
        dimensions = counted(len(self.radius), "component")
        if self._squared(0.5 for _ in self.radius) > 1:
            least = math.sqrt(len(self.radius)) / 2
            raise ValueError(
                "radius must be large enough that every observation lies within a receptive field: at least "
                f"{math.ceil(least * 1000) / 1000:g} for each of {dimensions}, got {_shown(self.radius)}"
            )
        if self._squared(count - 1 for count in self.centers) <= 1:
            most = math.sqrt(sum((count - 1) ** 2 for count in self.centers))
            raise ValueError(
                "radius must be small enough that an observation lies outside some receptive field: below "
                f"{math.floor(most * 1000) / 1000:g} for each of {dimensions} with {_shown(self.centers)} centers, got "
                f"{_shown(self.radius)}"
            )

    def _squared(self, distances: Iterable[float]) -> float:
        """Returns the squared distance of two points, in radii, from their distances between centers."""
        total = 0.0
        for distance, radius in zip(distances, self.radius, strict=True):
            z = distance / radius
            total += z * z
        return total

    def spec(self) -> CoarseSpec:
        """Returns the features as the extension takes them."""
        return {"type": "coarse", **self.box_spec(), "centers": self.centers, "radius": self.radius}


def _shown(numbers: Iterable[float]) -> str:
    listed = [f"{number:g}" for number in numbers]
    return f"({', '.join(listed)})" if len(listed) > 1 else listed[0]
