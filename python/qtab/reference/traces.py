"""Eligibility traces in plain NumPy: one for each weight (Sutton & Barto, 2nd ed., chapter 12)."""

import numpy as np

from qtab.reference.schedules import LearningRate
from qtab.reference.task import Rows, Table


def mark(z: Table, state: Rows, action: int, kind: str | None) -> None:
    """A visit of a pair: accumulating traces grow by 1, replacing ones become 1; clearing ends the other actions'."""
    for row in state:
        if kind == "accumulating":
            z[row, action] += 1.0
        else:
            if kind == "clearing":
                z[row] = 0.0
            z[row, action] = 1.0


def correct(Q: Table, z: Table, rate: LearningRate, error: float) -> None:
    """W <- w + α δ z, for the weights whose trace is not zero."""
    for row, action in np.argwhere(z != 0.0).tolist():
        Q[row, action] += rate.step(row, action) * error * z[row, action]


def decay(z: Table, factor: float, cutoff: float | None) -> None:
    """Z <- γλ z; what falls to the cutoff or below is forgotten."""
    z *= factor
    z[np.abs(z) <= (cutoff or 0.0)] = 0.0
