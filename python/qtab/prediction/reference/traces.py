"""TD(λ) and true online TD(λ) in plain NumPy (Sutton & Barto, 2nd ed., chapter 12)."""

import numpy as np

from qtab._utils.checks import required
from qtab.prediction.reference.common import Prediction


def td_lambda(prediction: Prediction) -> None:
    """Z <- γλ z + x, then w <- w + α δ z (the box in section 12.2)."""
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


def true_online_td_lambda(prediction: Prediction) -> None:
    """W <- w + α (δ + V - V_old) z - α (V - V_old) x with the dutch trace z (the box in section 12.5)."""
    decay = prediction.discount * required("trace_decay", prediction.settings.trace_decay)
    for episode in prediction.episodes():
        z, old_value = np.zeros_like(prediction.w), 0.0
        for visit in episode:
            rows = prediction.rows[visit.state]
            value, next_value = prediction.value(visit.state), prediction.next_value(visit)
            delta = visit.reward + prediction.discount * next_value - value
            alpha = prediction.rate.step(0, 0)
            overlap = 0.0
            for row in rows:
                overlap += float(z[row])
            z *= decay
            for row in rows:
                z[row] += 1.0 - alpha * decay * overlap
            prediction.w += alpha * (delta + (value - old_value)) * z
            for row in rows:
                prediction.w[row] -= alpha * (value - old_value)
            old_value = next_value
