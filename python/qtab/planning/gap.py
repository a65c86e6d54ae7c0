"""How far a run is from the truth."""

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", float, NDArray[np.float64])
"""A number for one run, (runs,) for many."""


@dataclass(frozen=True, eq=False)
class Gap(Generic[Number]):
    """The expected return of the optimum beside what a run came to; a gap is what is missing, 0 at best."""

    optimum: float
    """The expected return of the optimum."""
    final_return: Number
    """The mean of a run's last 100 returns, exploration and all."""
    greedy_return: Number
    """The expected return of its greedy policy under the time limit; NaN where the tables were not kept."""
    standard_error: Number
    """Of ``greedy_return``: 0 where it was computed exactly, from a table."""
    label: str = "optimum"
    """Whether the optimum is one, or the best that is known."""

    @property
    def final(self) -> Number:
        """How much the last episodes miss."""
        return self.optimum - self.final_return

    @property
    def greedy(self) -> Number:
        """How much the greedy policy misses."""
        return self.optimum - self.greedy_return

    def __str__(self) -> str:
        greedy, error, gap = (float(np.mean(part)) for part in (self.greedy_return, self.standard_error, self.greedy))
        exact = f" ± {error:.2g}" if error > 0 else ""
        return f"greedy policy {greedy:.4g}{exact}, {self.label} {self.optimum:.4g}, gap {gap:.2g}"
