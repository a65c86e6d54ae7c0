"""TD(λ) in plain NumPy (Sutton & Barto, 2nd ed., the box in section 12.2)."""

import numpy as np

from qtab._utils.checks import required
from qtab.prediction.reference.common import Prediction


def td_lambda(prediction: Prediction) -> None:
    """Z <- γλ z + x, then w <- w + α δ z."""
    decay = prediction.discount * required("trace_decay", prediction.settings.trace_decay)
    for episode in prediction.episodes():
        z = np.zeros_like(prediction.w)
        for visit in episode:
            z *= decay
            for row in prediction.rows[visit.state]:
                z[row] += 1.0
            next_value = prediction.next_value(visit)
            delta = visit.reward + prediction.discount * next_value - prediction.value(visit.state)
            prediction.w += prediction.rate.step(0, 0) * delta * z
