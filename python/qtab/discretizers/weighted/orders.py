"""Features numbered by vectors of integers up to an order, such as frequencies or exponents."""

from dataclasses import dataclass
from typing import Any

from qtab._utils.checks import required
from qtab.config import Config
from qtab.config.value_checks import MAX_FEATURES
from qtab.discretizers.weighted.features import WeightedFeatures


@dataclass(frozen=True, eq=False, repr=False)
class OrderedFeatures(WeightedFeatures):
    """Features of an order n: one for each vector of integers from 0 to n."""

    order: int
    """The largest integer."""
    coupled: bool
    """Whether there is a feature for each combination of integers, not only for those of single components."""

    @classmethod
    def options(cls, config: Config, dimensions: int) -> dict[str, Any]:  # noqa: ARG003
        """Returns the order, and whether the components are coupled."""
        return {"order": required("order", config.order), "coupled": required("coupled", config.coupled)}

    def check_options(self) -> None:
        """Raises an error for too many features.

        Raises:
            ValueError: if there are more than 1,024.
        """
        dimensions = len(self.low)
        count = n_features(dimensions, self.order, coupled=self.coupled)
        if count <= MAX_FEATURES:
            return
        fewer = n_features(dimensions, self.order, coupled=False)
        instead = f"; coupled=False gives {fewer:,}" if self.coupled and fewer <= MAX_FEATURES else ""
        given = f"{count:,}" if count < 10**9 else "more than a billion"
        raise ValueError(
            f"order must give at most {MAX_FEATURES:,} features, got {self.order} with {dimensions} components, which "
            f"gives {given}{instead}"
        )

    @property
    def description(self) -> str:
        """The order."""
        return f"of order {self.order}"

    @property
    def shape(self) -> tuple[int]:
        """The number of features."""
        return (n_features(len(self.low), self.order, coupled=self.coupled),)


def n_features(dimensions: int, order: int, *, coupled: bool) -> int:
    """Returns the number of features over so many components."""
    return (order + 1) ** dimensions if coupled else dimensions * order + 1
