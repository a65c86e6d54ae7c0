"""Polynomials as features (Sutton & Barto, 2nd ed., section 9.5.1)."""

from dataclasses import dataclass

from qtab._spec import PolynomialSpec
from qtab.discretizers.weighted.orders import OrderedFeatures

OF_FUNCTION = (
    "to learn with features of your own, return them as the observation with gymnasium.wrappers.TransformObservation, "
    "in a Box that contains them, and use discretizer='polynomial' with order=1 and coupled=False"
)
"""What to use instead of a function that returns features, for messages."""


@dataclass(frozen=True, eq=False, repr=False)
class PolynomialBasis(OrderedFeatures):
    """The products of powers of the components of states in [0, 1]^d, with exponents up to the order."""

    def spec(self) -> PolynomialSpec:
        """Returns the basis as the extension takes it."""
        return {"type": "polynomial", **self.box_spec(), "order": self.order, "coupled": self.coupled}
