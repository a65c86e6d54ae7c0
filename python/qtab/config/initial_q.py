"""The values of a Q table before the first episode."""

import numpy as np
from numpy.typing import NDArray

from qtab._spec import InitialQSpec


def initial_q_spec(initial_q: float | tuple[float, float] | NDArray[np.float64]) -> InitialQSpec:
    """Returns the setting ``initial_q`` as the extension takes it."""
    if isinstance(initial_q, np.ndarray):
        return {"type": "table", "values": initial_q}
    if isinstance(initial_q, tuple):
        low, high = initial_q
        return {"type": "uniform", "low": low, "high": high}
    return {"type": "constant", "value": initial_q}
