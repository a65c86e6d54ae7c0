"""Features around the centers of a grid."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from qtab._utils.checks import required
from qtab._utils.shown import counted
from qtab.config import Config
from qtab.config.value_checks import MAX_FEATURES
from qtab.discretizers.box import per_dimension
from qtab.discretizers.weighted.features import WeightedFeatures


@dataclass(frozen=True, eq=False, repr=False)
class CenteredFeatures(WeightedFeatures):
    """A feature for each center of a grid over the observations, in C order."""

    extent_name: ClassVar[Literal["width", "radius"]]
    """The setting that gives the extent of a feature."""

    centers: tuple[int, ...]
    """The number of centers along each component, evenly spaced from the lower limit to the upper one."""

    @classmethod
    def options(cls, config: Config, dimensions: int) -> dict[str, Any]:
        """Returns the number of centers and the extent of a feature along each component.

        Raises:
            ValueError: if there are too few or too many numbers.
        """
        extent = required(cls.extent_name, getattr(config, cls.extent_name))
        return {
            "centers": per_dimension("centers", required("centers", config.centers), dimensions),
            cls.extent_name: per_dimension(cls.extent_name, extent, dimensions),
        }

    def check_options(self) -> None:
        """Raises an error for too many features.

        Raises:
            ValueError: if there are more than 1,024.
        """
        if self.n_rows > MAX_FEATURES:
            given = f"{self.n_rows:,}" if self.n_rows < 10**9 else "more than a billion"
            dimensions = len(self.centers)
            most = max(count for count in range(1, max(self.centers) + 1) if count**dimensions <= MAX_FEATURES)
            instead = f"; centers={most} gives {most**dimensions:,}" if most > 1 else ""
            differ = len(set(self.centers)) > 1
            centers = self.centers if differ else f"{self.centers[0]} for each of {counted(dimensions, 'component')}"
            raise ValueError(
                f"centers must give at most {MAX_FEATURES:,} features, got {centers}, which gives {given}{instead}"
            )

    def settings(self) -> dict[str, Any]:
        """Returns the limits, and the number of centers and the extent of a feature along each component."""
        return {**super().settings(), "centers": self.centers, self.extent_name: getattr(self, self.extent_name)}

    @property
    def description(self) -> str:
        """The number of centers along each component."""
        return f"around {' × '.join(f'{count:,}' for count in self.centers)} centers"

    @property
    def shape(self) -> tuple[int]:
        """The number of features."""
        return (math.prod(self.centers),)
