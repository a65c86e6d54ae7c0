"""``qtab.Gap``: how far a run falls short of the optimum."""

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from qtab._utils.fields import with_fields

Number = TypeVar("Number", float, NDArray[np.float64])
"""A float for one run, (runs,) float64 for many."""


@with_fields
@dataclass(frozen=True, eq=False)
class Gap(Generic[Number]):
    """The expected return of the optimum, the returns of a run, and how much these fall short of it."""

    optimum: float
    """The expected return of the optimum."""
    final_return: Number
    """The mean return of the run's last 100 training episodes, which include exploration."""
    greedy_return: Number
    """The expected return of the run's greedy policy under the time limit; NaN if its Q tables were not kept."""
    standard_error: Number
    """The standard error of ``greedy_return``; 0 where that was computed exactly, from a transition table."""
    label: str = "optimum"
    """``"optimum"``, or ``"best known"`` where the optimum is not proven."""

    @property
    def final(self) -> Number:
        """The optimum minus ``final_return``."""
        return self.optimum - self.final_return

    @property
    def greedy(self) -> Number:
        """The optimum minus ``greedy_return``."""
        return self.optimum - self.greedy_return

    def __str__(self) -> str:
        greedy_return, standard_error, gap = (
            float(np.mean(value)) for value in (self.greedy_return, self.standard_error, self.greedy)
        )
        uncertainty = f" ± {standard_error:.2g}" if standard_error > 0 else ""
        return f"greedy policy {greedy_return:.4g}{uncertainty}, {self.label} {self.optimum:.4g}, gap {gap:.2g}"
