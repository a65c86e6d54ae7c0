"""Gaussian radial basis functions (Sutton & Barto, 2nd ed., section 9.5.5)."""

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from qtab._spec import RadialSpec
from qtab._utils.checks import required
from qtab.config import Config
from qtab.discretizers.weighted.centers import CenteredFeatures

_WIDEST = 10
"""The maximum width, in distances from the first center to the last."""


@dataclass(frozen=True, eq=False, repr=False)
class RadialBasis(CenteredFeatures):
    """The features exp(-‖s - c‖² / 2σ²) around the centers c of a grid."""

    extent_name: ClassVar[Literal["width"]] = "width"

    width: tuple[float, ...]
    """σ along each component, in distances between neighboring centers."""
    normalized: bool
    """Whether the features are divided by their sum, so that they sum to 1."""

    @classmethod
    def options(cls, config: Config, dimensions: int) -> dict[str, Any]:
        """Returns the number of centers and the width along each component, and whether features are normalized.

        Raises:
            ValueError: if there are too few or too many numbers.
        """
        return {**super().options(config, dimensions), "normalized": required("normalized", config.normalized)}

    def check_options(self) -> None:
        """Raises an error for too many features, or features that hardly differ.

        Raises:
            ValueError: if there are more than 1,024, or a width is too large.
        """
        super().check_options()
        for index, (width, count) in enumerate(zip(self.width, self.centers, strict=True)):
            if width > _WIDEST * (count - 1):
                raise ValueError(
                    f"width must be at most {_WIDEST * (count - 1)} with {count} centers along component {index}, "
                    f"because wider features hardly differ, got {width:g}"
                )

    def spec(self) -> RadialSpec:
        """Returns the basis as the extension takes it."""
        return {
            "type": "radial",
            **self.box_spec(),
            "centers": self.centers,
            "width": self.width,
            "normalized": self.normalized,
        }
