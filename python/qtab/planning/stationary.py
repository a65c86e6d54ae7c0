"""The best stationary policy known: one action for each observation, independent of the number of steps taken."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qtab._utils.fields import with_fields


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class StationaryPolicy:
    """A policy that does not depend on the number of steps taken, and its return under the time limit."""

    policy: NDArray[np.int64]
    """(*cells,): the action in each cell, as the environment numbers it."""
    expected_return: float
    """The undiscounted expected return under the time limit."""
    proven: bool
    """Whether no stationary policy returns more: true if no policy at all does."""

    @property
    def label(self) -> str:
        """``"best"``, or ``"best known"`` if it is not proven."""
        return "best" if self.proven else "best known"

    def __repr__(self) -> str:
        """A one-line summary without the actions."""
        return f"<StationaryPolicy: {self.label} expected return {self.expected_return:.6g}>"
