"""The Fourier basis (Konidaris, Osentoski & Thomas, 2011; Sutton & Barto, 2nd ed., section 9.5.2)."""

from dataclasses import dataclass
from typing import Any

from qtab._spec import FourierSpec
from qtab._utils.checks import required
from qtab.config import Config
from qtab.discretizers.weighted.orders import OrderedFeatures


@dataclass(frozen=True, eq=False, repr=False)
class FourierBasis(OrderedFeatures):
    """The features cos(π c·s) of states s in [0, 1]^d, with frequency vectors c of integers up to the order."""

    scale_step_sizes: bool
    """Whether the learning rate of a feature is divided by the length of its frequency vector c."""

    @classmethod
    def options(cls, config: Config, dimensions: int) -> dict[str, Any]:
        """Returns the order, whether the components are coupled, and whether step sizes are scaled."""
        scale_step_sizes = required("scale_step_sizes", config.scale_step_sizes)
        return {**super().options(config, dimensions), "scale_step_sizes": scale_step_sizes}

    def spec(self) -> FourierSpec:
        """Returns the basis as the extension takes it."""
        return {
            "type": "fourier",
            **self.box_spec(),
            "order": self.order,
            "coupled": self.coupled,
            "scale_step_sizes": self.scale_step_sizes,
        }
