"""An estimate with its interval."""

from dataclasses import dataclass


@dataclass(frozen=True, repr=False)
class Interval:
    """An estimate and its interval."""

    estimate: float
    low: float
    high: float
    confidence: float
    """The nominal coverage: the probability with which such an interval contains the true value."""
    method: str
    """``"t"`` (Student's), ``"BCa"``, ``"percentile"`` (where BCa has no finite bounds), ``"stratified percentile"``,
    ``"constant"`` (all values equal: the width of zero only means that the sample shows no variation), ``"Wilson"`` or
    ``"order statistics"``."""

    def __repr__(self) -> str:
        """Returns one line, with six digits."""
        return f"<Interval {self}, {100 * self.confidence:g} %, {self.method}>"

    def __str__(self) -> str:
        return f"{self.estimate:.6g} [{self.low:.6g}, {self.high:.6g}]"
