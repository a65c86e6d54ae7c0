"""An estimate with its interval."""

import math
from dataclasses import dataclass

NARROW, WIDE = 1e-6, 1e7
"""Intervals whose half is narrower or wider, and larger estimates, are shown with six digits."""


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
        """Returns one line, with the digits that the width of the interval allows."""
        return f"<Interval {self}, {100 * self.confidence:g} %, {self.method}>"

    def __str__(self) -> str:
        """Returns the numbers rounded to two digits of half the width, or to six digits if it is extreme."""
        half = (self.high - self.low) / 2
        if not NARROW < half < WIDE or abs(self.estimate) > WIDE:
            return f"{self.estimate:.6g} [{self.low:.6g}, {self.high:.6g}]"
        digits = max(0, 1 - math.floor(math.log10(half)))
        # 0.0 turns a negative zero into zero
        estimate, low, high = (f"{round(x, digits) + 0.0:.{digits}f}" for x in (self.estimate, self.low, self.high))
        return f"{estimate} [{low}, {high}]"
